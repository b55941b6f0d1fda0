"""Random codes of valid files that use every feature of the format."""
import random

import gscl_decoder as gscl
from scene import ALPHA, DEFAULT_STEPS, NORMALIZED, RGB, RGB_ALPHA, SUM, Scene

FRAMES = (3, 2), (4, 3), (16, 9), (16, 10), (5, 4), (2, 1), (1, 1)  # ratios with a symbol of their own


def random_scene(seed, kinds=None):
    """(codes, names of the features that they use); the same for the same arguments.

    kinds: how many kinds of files there are, each of which needs kernels of its own.
    """
    pick = random.Random(seed)
    width, height = size(pick)
    n = count(pick)
    options = kind(random.Random(seed % kinds if kinds else -1 - seed))
    layers = pick.randint(2, 8) if options["coding"] == gscl.SCALAR and n > 0 and pick.random() < 0.2 else 1
    scene = Scene(width, height, n, steps=steps(pick, n), blocks=blocks(pick), layers=layers,
                  pivot=pick.choice((None, None, pick.randrange(64))), **options)
    scene.background = background(pick, scene) if n == 0 or pick.random() < 0.5 else None
    if scene.coding == gscl.CODEBOOK and n > 0:
        style = fill_books(pick, scene)
    else:
        style = pick.choice(STYLES)
        style(pick, scene)
        style = style.__name__
    return scene, features(scene, style)


def kind(pick):
    """The options of a scene, some of which have no effect together."""
    maybe = lambda probability: int(pick.random() < probability)
    if maybe(0.1):
        return {"coding": gscl.SCALAR, "texture": maybe(0.5)}  # the kind that takes one symbol
    return {"coding": gscl.CODEBOOK if maybe(0.25) else gscl.SCALAR, "blend": pick.choice((NORMALIZED, ALPHA, SUM)),
            "layout": pick.choice((0, 1, RGB, RGB, RGB_ALPHA, RGB_ALPHA)), "high": maybe(0.25), "chroma": maybe(0.85),
            "alpha": maybe(0.85), "opacity": maybe(0.5), "anisotropy": maybe(0.85), "rotation": maybe(0.85), "texture": maybe(0.5)}


def size(pick):
    """Pixels: mostly small, since the decoder in Python draws each of them."""
    kind = pick.randrange(20)
    if kind == 0:
        return 1, 1
    if kind < 3:
        return pick.choice(((1, pick.randint(1, 80)), (pick.randint(1, 80), 1)))
    if kind < 7:
        (a, b), times = pick.choice(FRAMES), pick.randint(1, 3)
        return (a * times, b * times) if pick.random() < 0.5 else (b * times, a * times)
    if kind == 7:
        return pick.choice(((64, pick.randint(1, 64)), (pick.randint(1, 64), 64), (128, 5), (300, pick.randint(1, 9))))
    return pick.randint(2, 28), pick.randint(2, 28)


def count(pick):
    kind = pick.randrange(40)
    if kind == 0:
        return 0
    if kind < 6:
        return 1
    if kind == 6:
        return pick.randint(257, 760)
    return pick.randint(2, 9) if kind < 24 else pick.randint(10, 40)


def steps(pick, n):
    kind = pick.randrange(3)
    if kind == 0:
        fine = int(n >= 640)
        return *DEFAULT_STEPS[:3], 5 + fine, 3 + fine, *DEFAULT_STEPS[5:]
    if kind == 1:
        return tuple(pick.randrange(16) for _ in DEFAULT_STEPS)
    return tuple(pick.choice((step, pick.randrange(16), 0, 15)) for step in DEFAULT_STEPS)


def background(pick, scene):
    peak = 65535 if scene.high_bit_depth else 255
    return [pick.choice((0, peak, pick.randint(0, peak))) for _ in range(scene.channels)]


def blocks(pick):
    """The bare form has none, which the caller sees to."""
    if pick.random() < 0.7:
        return []
    content = lambda: bytes(pick.randrange(256) for _ in range(pick.choice((0, 1, 5, 127, 128, 300))))
    kinds = [kind for kind in (0, 1, 32, 33) if pick.random() < 0.5]
    return [(kind, bytes((pick.randrange(256), pick.randrange(256))) if kind == 0 else content()) for kind in kinds]


# ---- Splats of scalar coding ----------------------------------------------------------------------------------------

def colours(pick, scene, wild):
    """luma, Co, Cg, alpha: mostly within 0..1, or with `wild` up to the ends of their ranges."""
    L, C, A = (scene.levels[name] for name in ("luma", "chroma", "alpha"))
    if not wild:
        return pick.randint(0, L), pick.randint(-C // 3, C // 3), pick.randint(-C // 3, C // 3), pick.randint(A // 4, A)
    chroma = lambda: pick.choice((-C, C, pick.randint(-C, C)))
    luma, alpha = (pick.choice((*scene.limits(name), pick.randint(*scene.limits(name)), 0)) for name in ("luma", "alpha"))
    return luma, chroma(), chroma(), alpha


def wave(pick, probability=0.4):
    if pick.random() >= probability:
        return ()
    return pick.choice((1, 16, pick.randint(1, 16))), pick.randrange(16), pick.randrange(16), pick.randrange(8)


def put(pick, scene, major, aspect=0, place=None, wild=False, opacity=None, times=1, colour=None):
    x, y = place or (pick.random(), pick.random())
    times = min(times, scene.n - len(scene.splats))
    opacity = pick.randint(0, scene.step["opacity"]) if opacity is None else opacity
    layer = len(scene.splats) * scene.layers // scene.n
    aspect = min(aspect, major) if scene.has_anisotropy else 0
    angle = pick.randrange(scene.angle_count(aspect))
    scene.add(major, aspect, angle, x, y, *(colour or colours(pick, scene, wild)), opacity, *wave(pick) or (0,) * 4,
              count=times, layer=layer)


def is_full(scene):
    return len(scene.splats) == scene.n


def ordinary(pick, scene):
    """Sizes around the typical one."""
    centre = scene.typical()
    while not is_full(scene):
        major = max(0, min(63, centre + pick.randint(-6, 4)))
        put(pick, scene, major, pick.choice((0, pick.randint(0, 12), pick.randint(0, major))))


def any_codes(pick, scene):
    """Every code that is allowed."""
    while not is_full(scene):
        major = pick.randrange(64)
        put(pick, scene, major, pick.randint(0, major), wild=True)


def tiny_opacity(pick, scene):
    """Many splats that hardly show, or one in front of them that does."""
    while not is_full(scene):
        put(pick, scene, min(63, scene.typical() + pick.randint(0, 8)), opacity=0, wild=pick.random() < 0.5)


def cancelling(pick, scene):
    """Pairs of opposite colours at one place."""
    while not is_full(scene):
        luma, co, cg, alpha = colours(pick, scene, True)
        low, high = scene.limits("luma")
        place, major = (pick.random(), pick.random()), max(0, min(63, scene.typical() + pick.randint(-2, 8)))
        put(pick, scene, major, 0, place, colour=(luma, co, cg, alpha))
        if not is_full(scene):
            put(pick, scene, major, 0, place, colour=(max(low, min(high, -luma)), -co, -cg, alpha))


def needles(pick, scene):
    """One axis much longer than the other."""
    while not is_full(scene):
        major = pick.randint(min(10, scene.typical() + 4), 63)
        put(pick, scene, major, pick.choice((major, max(0, major - pick.randint(0, 3)))), wild=pick.random() < 0.3)


def large(pick, scene):
    while not is_full(scene):
        major = pick.randint(min(63, scene.typical() + 4), 63)
        put(pick, scene, major, pick.randint(0, major // 2), wild=pick.random() < 0.3)


def small(pick, scene):
    """Axes of half a pixel and a little more."""
    while not is_full(scene):
        major = pick.randint(0, max(1, scene.typical() - 4))
        put(pick, scene, major, pick.randint(0, major))


def equal(pick, scene):
    """The same splat many times."""
    while not is_full(scene):
        put(pick, scene, max(0, min(63, scene.typical() + pick.randint(-3, 3))), times=pick.randint(2, 300))


def at_the_border(pick, scene):
    """In the last cells, whose centres may be outside the image, and in the first."""
    while not is_full(scene):
        place = pick.choice((0, 1, pick.random())), pick.choice((0, 1))
        put(pick, scene, pick.randint(0, 63), pick.randint(0, 20), place)


STYLES = ordinary, ordinary, any_codes, tiny_opacity, cancelling, needles, large, small, equal, at_the_border


# ---- Splats of codebook coding --------------------------------------------------------------------------------------

def fill_books(pick, scene):
    bits = lambda: pick.choice((1, 16, pick.randint(2, 12)))
    few = lambda: pick.choice((1, pick.randint(2, 6), pick.randint(2, 40)))
    shape = sorted((pick.choice((0, pick.randint(0, 300))), pick.choice((640, pick.randint(100, 400)))))
    if pick.random() < 0.5:
        shape = 96, 256  # 1/2 to 16 pixels
    colour = sorted((pick.choice((-255, 0, pick.randint(-60, 100))), pick.choice((510, 255, pick.randint(150, 300)))))
    scene.books(pick.randrange(1 << 30), few(), few(), bits(), bits(), bits(), tuple(shape), tuple(colour))
    low = pick.choice((0, 1, 60))
    if scene.has_opacity:
        scene.colour_ranges[-1] = low, pick.choice((low, 255))
    return "books"


# ---- What is in them ------------------------------------------------------------------------------------------------

def features(scene, style):
    found = {style, ("normalized", "alpha", "sum")[scene.blend], ("scalar", "codebook")[scene.coding],
             ("grey", "grey-alpha", "rgb", "rgb-alpha")[scene.layout], f"{16 if scene.high_bit_depth else 8} bits",
             "own background" if scene.background else "mean background"}
    found |= {name for name in gscl.FLAGS if getattr(scene, name)}
    found |= {f"block {kind}" for kind, _ in scene.blocks}
    counts = {0: "no splats", 1: "one splat"}
    found.add(counts.get(scene.n, "640 splats or more" if scene.n >= 640 else "256 splats or more" if scene.n > 255 else "few splats"))
    found |= {"layers"} if scene.layers > 1 else set()
    found |= {"wide grid"} if max(scene.width, scene.height) > 128 else set()
    found |= {"one pixel wide or high"} if min(scene.width, scene.height) == 1 else set()
    found |= {"waves"} if any(getattr(splat, "amplitude", 0) for splat in scene.splats) else set()
    return found
