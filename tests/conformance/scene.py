"""Codes of pictures that are chosen rather than decoded."""
import pathlib
import random
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "decoder"))

import gscl_decoder as gscl

NORMALIZED, ALPHA, SUM = range(3)
GREY, GREY_ALPHA, RGB, RGB_ALPHA = range(4)
DEFAULT_STEPS = (6, 8, 4, 5, 3, 4, 3)
OCTAVES = (4, 8, 4, 5, 3, 4, 3)  # four axes an octave: code 4 n is 2^(n - 1) pixels


class Scene(gscl.Picture):
    """Codes that are chosen rather than decoded.  Flags and steps that are not in use are cleared."""

    def __init__(self, width=16, height=12, n=0, blend=NORMALIZED, coding=gscl.SCALAR, layout=RGB, high=0, chroma=1, alpha=1,
                 opacity=0, anisotropy=1, rotation=1, texture=0, steps=DEFAULT_STEPS, background=None, blocks=(),
                 layers=1, pivot=None):
        super().__init__()
        self.width, self.height, self.n, self.blend, self.coding = width, height, n, blend, coding
        self.layout, self.high_bit_depth = layout, high
        self.has_chroma = int(chroma and layout in (RGB, RGB_ALPHA))
        self.has_alpha = int(alpha and layout in (GREY_ALPHA, RGB_ALPHA))
        self.has_opacity, self.has_anisotropy, self.has_rotation = opacity, anisotropy, int(rotation and anisotropy)
        self.has_texture = int(texture and coding == gscl.SCALAR)
        used = (1, 1, self.has_rotation, 1, self.has_chroma, self.has_alpha, opacity)
        stored = coding == gscl.SCALAR and n > 0
        self.step = dict(zip(gscl.STEPS, (step if use and stored else 0 for step, use in zip(steps, used))))
        self.levels = {name: gscl.LEVELS[self.step[name]] for name in ("luma", "chroma", "alpha")}
        self.channels = (3 if self.has_chroma else 1) + self.has_alpha
        self.background = list(background) if background else None if n > 0 else [32768 if high else 128] * self.channels
        self.blocks = list(blocks)
        self.layers = layers
        self.pivot = (self.typical() if pivot is None else pivot) if stored else 0

    def fine(self, level, lowest, highest, F):
        """A code of this level: at the ends of the range its ends."""
        return level * F + (0 if level == lowest else F - 1 if level == highest else len(self.splats) * 5 % F)

    def add(self, major, aspect=0, angle=0, x=0.5, y=0.5, luma=0, co=0, cg=0, alpha=None, opacity=0, amplitude=0, wave=0,
            direction=0, phase=0, count=1, layer=0):
        """x and y are places in the image, from 0 to 1; luma, co and cg are levels."""
        splat = gscl.Splat()
        splat.layer = layer
        splat.major, splat.aspect, splat.angle = major, aspect if self.has_anisotropy else 0, angle
        C = self.angle_count(splat.aspect)
        if not self.has_rotation:
            splat.angle = 0
        parts = self.parts(splat.aspect)
        steep = C < 4 * splat.angle < 3 * C
        cells_x = self.cells(major, self.width) * (parts if steep else 1)
        cells_y = self.cells(major, self.height) * (1 if steep else parts)
        splat.x, splat.y = min(int(x * cells_x), cells_x - 1), min(int(y * cells_y), cells_y - 1)
        splat.F = F = self.fineness(major, splat.aspect)
        L = self.levels["chroma"]
        splat.luma, splat.opacity = self.fine(luma, *self.limits("luma"), F), opacity if self.has_opacity else 0
        splat.co, splat.cg = (self.fine(level, -L, L, F) if self.has_chroma else 0 for level in (co, cg))
        splat.alpha = (self.levels["alpha"] if alpha is None else alpha) if self.has_alpha else 0
        splat.amplitude, splat.wave, splat.direction, splat.phase = \
            (amplitude, wave, direction, phase) if self.has_texture and amplitude else (0, 0, 0, 0)
        self.splats += [splat] * count
        return self

    def add_indexed(self, shape, colour, x, y, count=1):
        splat = gscl.Splat()
        splat.shape, splat.colour, splat.x, splat.y = shape, colour, x, y
        self.splats += [splat] * count
        return self

    def fill(self, seed, majors=None):
        """Random splats of moderate sizes, up to n."""
        pick = random.Random(seed)
        centre = self.typical()
        low, high = majors or (max(centre - 6, 0), min(centre + 4, 63))
        while len(self.splats) < self.n:
            major = pick.randint(low, high)
            aspect = pick.choice((0, pick.randint(0, min(major, 12)), pick.randint(0, major))) if self.has_anisotropy else 0
            L, A, O = self.levels["luma"], self.levels["alpha"], self.step["opacity"]
            chroma = self.levels["chroma"] // 3
            self.add(major, aspect, pick.randrange(self.angle_count(aspect)), pick.random(), pick.random(),
                     pick.randint(*self.limits("luma")) if pick.random() < 0.2 else pick.randint(0, L),
                     pick.randint(-chroma, chroma), pick.randint(-chroma, chroma), pick.randint(A // 4, A),
                     pick.randint(0, O), pick.choice((0, pick.randint(1, 8))), pick.randrange(16), pick.randrange(16),
                     pick.randrange(8), layer=len(self.splats) * self.layers // self.n)
        return self

    def books(self, seed, shapes=3, colours=4, position_bits=5, shape_bits=4, colour_bits=5, shape=None, colour=None):
        """Random codebooks; then splats, up to n."""
        pick = random.Random(seed)
        self.position_bits, self.shape_bits, self.colour_bits = position_bits, shape_bits, colour_bits
        axes = shape or (110, 210)
        self.shape_ranges = [axes] * (1 + self.has_anisotropy) + [(0, 256)] * self.has_rotation
        self.colour_ranges = [colour or (-20, 280)] * self.channels + [(60, 255)] * self.has_opacity
        word = lambda ranges, bits: [pick.randrange(1 << bits) for _ in ranges]
        self.shape_words = sorted((word(self.shape_ranges, shape_bits) for _ in range(shapes)), key=lambda w: -w[0])
        self.colour_words = sorted((word(self.colour_ranges, colour_bits) for _ in range(colours)), key=lambda w: w[0])
        while len(self.splats) < self.n:
            self.add_indexed(pick.randrange(shapes), pick.randrange(colours), pick.randrange(1 << position_bits),
                             pick.randrange(1 << position_bits))
        return self
