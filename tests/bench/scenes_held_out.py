#!/usr/bin/env python3
"""Draws a second set of images, on which no threshold of the encoder was tuned, as PNG files into a folder:

    sh tests/bench/bench.sh scenes_held_out FOLDER

Screenshots with text, comics, maps, charts, noise, gradients, and the photographs of scikit-image with and without frames.
scenes.py draws the set on which the thresholds were found.
"""
import pathlib
import sys

import matplotlib
import numpy
import skimage.data
from PIL import Image, ImageDraw, ImageFont

WIDTH, HEIGHT = 384, 256
X, Y = numpy.meshgrid(numpy.linspace(-1, 1, WIDTH), numpy.linspace(-HEIGHT / WIDTH, HEIGHT / WIDTH, HEIGHT))
FONTS = pathlib.Path(matplotlib.get_data_path()) / "fonts" / "ttf"
PROSE = ("Every window keeps its own history, so that a change in one place can be undone without losing later work elsewhere. "
         "Files are saved as soon as they are closed; a copy of the last version remains for a week. ")
CODE = ("def area(shape):", "    if shape.kind == 'circle':", "        return pi * shape.radius ** 2", "    total = 0.0",
        "    for a, b in shape.edges():", "        total += a.x * b.y - b.x * a.y", "    return abs(total) / 2", "",
        "class Shape:", "    kind = 'polygon'", "    def edges(self):", "        yield from zip(self.points, self.points[1:])")


def font(size, name="DejaVuSans"):
    return ImageFont.truetype(str(FONTS / f"{name}.ttf"), size)


def colour(random, low=0, high=256):
    return tuple(int(value) for value in random.integers(low, high, 3))


def image_of(planes):
    """An image of samples in 0..1."""
    return Image.fromarray(numpy.clip(numpy.rint(255 * planes), 0, 255).astype(numpy.uint8))


def smooth_noise(random, cells):
    """Noise with about `cells` features along the longer side, in -1..1."""
    coarse = Image.fromarray(random.uniform(-1, 1, (cells * HEIGHT // WIDTH + 2, cells + 2)).astype(numpy.float32))
    return numpy.asarray(coarse.resize((WIDTH, HEIGHT), Image.Resampling.BICUBIC))


def photograph(name, width=WIDTH, height=HEIGHT):
    """A photograph of scikit-image, cut to the middle and shrunk to this size."""
    image = Image.fromarray(getattr(skimage.data, name)()).convert("RGB")
    scale = max(width / image.width, height / image.height)
    image = image.resize((round(image.width * scale + 0.5), round(image.height * scale + 0.5)), Image.Resampling.LANCZOS)
    left, top = (image.width - width) // 2, (image.height - height) // 2
    return image.crop((left, top, left + width, top + height))


def wrapped(draw, text, box, face, fill, spacing=3):
    """Sets text in lines that fit the box."""
    left, top, right, bottom = box
    line, y = "", top
    for word in text.split():
        if draw.textlength(f"{line} {word}", face) > right - left:
            draw.text((left, y), line, fill, face)
            line, y = "", y + face.size + spacing
            if y + face.size > bottom:
                return
        line = f"{line} {word}".strip()
    draw.text((left, y), line, fill, face)


def screenshot_document(random):
    """A light window with a title bar, a sidebar, headings and paragraphs."""
    image = Image.new("RGB", (WIDTH, HEIGHT), (250, 250, 250))
    draw = ImageDraw.Draw(image)
    accent = colour(random, 30, 160)
    draw.rectangle((0, 0, WIDTH, 22), accent)
    draw.text((8, 4), "Notes - History", "white", font(12))
    draw.rectangle((0, 23, 92, HEIGHT), (232, 234, 237))
    for row in range(9):
        if row == 2:
            draw.rectangle((4, 27 + 22 * row, 88, 46 + 22 * row), (205, 214, 230))
        draw.text((10, 31 + 22 * row), f"Chapter {row + 1}", (60, 64, 70), font(11))
    draw.text((104, 32), "Keeping versions", (20, 20, 20), font(18))
    words = PROSE.split() * 6
    wrapped(draw, " ".join(random.permutation(words)), (104, 60, WIDTH - 12, 160), font(10), (40, 40, 40))
    draw.rounded_rectangle((104, 172, 200, 196), 6, accent)
    draw.text((122, 177), "Restore", "white", font(11))
    wrapped(draw, " ".join(random.permutation(words)), (104, 206, WIDTH - 12, HEIGHT - 4), font(10), (40, 40, 40))
    return image


def screenshot_editor(random):
    """A dark editor with coloured source text and line numbers."""
    image = Image.new("RGB", (WIDTH, HEIGHT), (30, 32, 40))
    draw = ImageDraw.Draw(image)
    palette = [(198, 120, 221), (152, 195, 121), (97, 175, 239), (229, 192, 123), (220, 223, 228)]
    draw.rectangle((0, 0, 30, HEIGHT), (38, 40, 50))
    for row in range(18):
        draw.text((6, 4 + 14 * row), f"{row + 1:2}", (110, 115, 130), font(10, "DejaVuSansMono"))
        x = 38.0
        for word in CODE[(row + int(random.integers(0, 2))) % len(CODE)].replace(" ", " \0").split("\0"):
            draw.text((x, 4 + 14 * row), word, palette[int(random.integers(0, len(palette)))], font(10, "DejaVuSansMono"))
            x += draw.textlength(word, font(10, "DejaVuSansMono"))
    return image


def comic(random):
    """Panels with black outlines, flat fills, halftone dots and speech balloons."""
    image = Image.new("RGB", (2 * WIDTH, 2 * HEIGHT), "white")
    draw = ImageDraw.Draw(image)
    for left, top, right, bottom in ((12, 12, 370, 250), (390, 12, 756, 250), (12, 266, 500, 500), (516, 266, 756, 500)):
        draw.rectangle((left, top, right, bottom), colour(random, 120), "black", 5)
        spot = colour(random, 40, 200)
        for y in range(top + 10, bottom - 90, 12):
            for x in range(left + 10, right - 8, 12):
                draw.ellipse((x - 3, y - 3, x + 3, y + 3), spot)
        middle = int(random.uniform(left + 80, right - 80))
        draw.ellipse((middle - 40, bottom - 150, middle + 40, bottom - 60), (250, 205, 170), "black", 4)
        draw.rectangle((middle - 55, bottom - 62, middle + 55, bottom - 3), colour(random), "black", 4)
        for side in (-16, 16):
            draw.ellipse((middle + side - 5, bottom - 115, middle + side + 5, bottom - 105), "black")
        draw.ellipse((left + 14, top + 12, left + 170, top + 74), "white", "black", 3)
        draw.text((left + 36, top + 32), "WHO IS THERE?", "black", font(15))
    return image.resize((WIDTH, HEIGHT), Image.Resampling.LANCZOS)


def street_map(random):
    """Blocks, water, parks, roads of two widths and names."""
    image = Image.new("RGB", (2 * WIDTH, 2 * HEIGHT), (242, 239, 233))
    draw = ImageDraw.Draw(image)
    shore = [(x, 2 * HEIGHT * 0.75 + 40 * numpy.sin(x / 90 + random.uniform(0, 0.2))) for x in range(0, 2 * WIDTH + 20, 20)]
    draw.polygon([(0, 2 * HEIGHT), *shore, (2 * WIDTH, 2 * HEIGHT)], (170, 211, 223))
    for _ in range(5):
        x, y = random.uniform(0, 2 * WIDTH), random.uniform(0, 300)
        draw.polygon([(x + random.uniform(20, 90) * numpy.cos(a), y + random.uniform(20, 70) * numpy.sin(a))
                      for a in numpy.arange(0, 6.2, 0.7)], (200, 226, 175))
    for width, edge, fill, count in ((6, (200, 196, 190), "white", 26), (14, (215, 160, 90), (252, 214, 164), 6)):
        for _ in range(count):
            angle, x, y = random.choice([0.2, 1.77]) + random.normal(0, 0.08), random.uniform(0, 768), random.uniform(0, 400)
            ends = [(x - 900 * numpy.cos(angle), y - 900 * numpy.sin(angle)), (x + 900 * numpy.cos(angle), y + 900 * numpy.sin(angle))]
            draw.line(ends, edge, width + 3)
            draw.line(ends, fill, width)
    for name in ("Harbour", "Mill Lane", "Old Market", "North Gate", "Station", "Church Street"):
        draw.text((random.uniform(20, 600), random.uniform(10, 480)), name, (70, 70, 80), font(20))
    return image.resize((WIDTH, HEIGHT), Image.Resampling.LANCZOS)


def bar_chart(random):
    """Bars, axes and labels on white."""
    image = Image.new("RGB", (WIDTH, HEIGHT), "white")
    draw = ImageDraw.Draw(image)
    for tick in range(6):
        y = 220 - 38 * tick
        draw.line((40, y, WIDTH - 12, y), (220, 220, 220))
        draw.text((14, y - 6), f"{10 * tick}", (80, 80, 80), font(10))
    for bar in range(10):
        height = random.uniform(20, 185)
        draw.rectangle((50 + 32 * bar, 220 - height, 70 + 32 * bar, 220), [(66, 113, 174), (221, 132, 82), (85, 168, 104)][bar % 3])
        draw.text((52 + 32 * bar, 226), f"Q{bar + 1}", (80, 80, 80), font(10))
    draw.line((40, 20, 40, 220, WIDTH - 12, 220), "black")
    return image


def line_chart(random):
    """Thin antialiased curves over a grid."""
    image = Image.new("RGB", (3 * WIDTH, 3 * HEIGHT), "white")
    draw = ImageDraw.Draw(image)
    for x in range(120, 3 * WIDTH, 130):
        draw.line((x, 30, x, 690), (225, 225, 230), 2)
    for y in range(30, 700, 110):
        draw.line((120, y, 3 * WIDTH - 30, y), (225, 225, 230), 2)
    for shade in ((31, 119, 180), (255, 127, 14), (44, 160, 44), (214, 39, 40)):
        values = numpy.cumsum(random.normal(0, 14, 100)) + random.uniform(200, 500)
        draw.line([(120 + 10 * i, min(max(v, 30), 690)) for i, v in enumerate(values)], shade, 5)
    draw.line((120, 30, 120, 690, 3 * WIDTH - 30, 690), "black", 3)
    return image.resize((WIDTH, HEIGHT), Image.Resampling.LANCZOS)


def white_noise(random):
    return Image.fromarray(random.integers(0, 256, (HEIGHT, WIDTH, 3), dtype=numpy.uint8))


def film_grain(random):
    """One tone with grain of a standard deviation of 6."""
    grain = random.normal(0, 6 / 255, (HEIGHT, WIDTH, 1))
    return image_of(numpy.array([0.55, 0.5, 0.45]) + grain)


def clouds(random):
    """Noise of many scales, without an edge."""
    field = sum(smooth_noise(random, cells) / cells for cells in (3, 6, 12, 24, 48, 96))
    t = (field - field.min())[..., None] / numpy.ptp(field)
    return image_of((1 - t) * numpy.array([0.2, 0.4, 0.75]) + t * numpy.array([0.97, 0.97, 0.95]))


def conic_gradient(random):
    """Hue around the middle, brightness from it."""
    angle = (numpy.arctan2(Y, X) + random.uniform(0, 6.28))[..., None]
    return image_of((0.5 + 0.45 * numpy.cos(angle - numpy.array([0, 2.09, 4.19]))) * (0.4 + 0.6 * numpy.exp(-(X ** 2 + Y ** 2)))[..., None])


def banded_gradient(random):
    """A gradient of few tones: borders without texture."""
    t = numpy.floor(8 * (0.5 + 0.5 * X * 0.7 + 0.4 * Y)) / 8
    return image_of(numpy.stack([0.2 + 0.7 * t, 0.3 + 0.4 * t ** 2, 0.8 - 0.5 * t], 2) + 0.02 * random.uniform(0, 1))


def photo(random):
    return photograph(str(random.choice(["astronaut", "coffee", "rocket"])))


def photo_cat(random):
    return photograph("chelsea")


def photo_framed(random):
    """A photograph in a white mount with a black frame."""
    image = Image.new("RGB", (WIDTH, HEIGHT), "white")
    ImageDraw.Draw(image).rectangle((0, 0, WIDTH - 1, HEIGHT - 1), None, (25, 22, 20), 10)
    image.paste(photograph(str(random.choice(["astronaut", "coffee"])), 256, 164), (64, 46))
    return image


def photo_letterbox(random):
    """A wide photograph between black bars."""
    image = Image.new("RGB", (WIDTH, HEIGHT), "black")
    image.paste(photograph(str(random.choice(["rocket", "coffee"])), WIDTH, 160), (0, 48))
    return image


def photo_nearly_grey(random):
    """A photograph with a twentieth of its colour."""
    image = numpy.asarray(photograph(str(random.choice(["astronaut", "coffee", "chelsea"]))), float) / 255
    luma = image.mean(2, keepdims=True)
    return image_of(luma + 0.05 * (image - luma))


def photo_deep_field(_):
    """Galaxies on a nearly black sky."""
    return photograph("hubble_deep_field")


def photo_cut_out(random):
    """A photograph inside an ellipse, transparent outside."""
    image = photograph(str(random.choice(["astronaut", "chelsea"])))
    mask = Image.new("L", (4 * WIDTH, 4 * HEIGHT), 0)
    ImageDraw.Draw(mask).ellipse((160, 40, 4 * WIDTH - 160, 4 * HEIGHT - 40), 255)
    image.putalpha(mask.resize((WIDTH, HEIGHT), Image.Resampling.LANCZOS))
    return image


def scanned_page(_):
    """Printed text under uneven light."""
    return photograph("page").convert("L")


SCENES = [screenshot_document, screenshot_editor, comic, street_map, bar_chart, line_chart, white_noise, film_grain, clouds,
          conic_gradient, banded_gradient, photo, photo_cat, photo_framed, photo_letterbox, photo_nearly_grey, photo_deep_field,
          photo_cut_out, scanned_page]


def draw_all(folder):
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for number, scene in enumerate(SCENES):
        scene(numpy.random.default_rng(1000 + number)).save(folder / f"{scene.__name__}.png")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    draw_all(sys.argv[1])
