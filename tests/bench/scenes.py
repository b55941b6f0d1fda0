#!/usr/bin/env python3
"""Draws images of many kinds, which need different effects, as PNG files into a folder:

    sh tests/bench/bench.sh scenes FOLDER
"""
import pathlib
import sys

import numpy
from PIL import Image, ImageDraw, ImageFilter

WIDTH, HEIGHT = 384, 256
X, Y = numpy.meshgrid(numpy.arange(WIDTH) + 0.5, numpy.arange(HEIGHT) + 0.5)


def eight_bits(planes):
    return Image.fromarray(numpy.clip(numpy.rint(255 * planes), 0, 255).astype(numpy.uint8))


def blobs(random, count, sigma, power=1.0):
    """Round lights on black, with sigmas in pixels from the range `sigma`."""
    planes = numpy.zeros((HEIGHT, WIDTH, 3))
    for _ in range(count):
        x, y, s = random.uniform(0, WIDTH), random.uniform(0, HEIGHT), random.uniform(*sigma)
        light = numpy.exp(-(((X - x) ** 2 + (Y - y) ** 2) / (2 * s * s)) ** power)
        planes += light[..., None] * random.uniform(0.3, 1, 3) * random.uniform(0.3, 1)
    return planes


def noise(random, sigma):
    """Blurred noise of unit variance."""
    field = numpy.fft.rfft2(random.normal(size=(HEIGHT, WIDTH)))
    frequencies = numpy.fft.fftfreq(HEIGHT)[:, None] ** 2 + numpy.fft.rfftfreq(WIDTH)[None, :] ** 2
    field = numpy.fft.irfft2(field * numpy.exp(-2 * (numpy.pi * sigma) ** 2 * frequencies), (HEIGHT, WIDTH))
    return field / field.std()


def stars(random):
    return eight_bits(blobs(random, 160, (0.8, 2.2)))


def bokeh(random):
    return eight_bits(0.05 + blobs(random, 40, (8, 22), 4.0) * 0.7)


def nebula(random):
    return eight_bits(0.2 + blobs(random, 60, (10, 40)) * 0.25)


def dots(random):
    image = Image.new("RGB", (WIDTH, HEIGHT), (240, 236, 220))
    draw = ImageDraw.Draw(image)
    for y in range(12, HEIGHT, 24):
        for x in range(12, WIDTH, 24):
            draw.ellipse((x - 5, y - 5, x + 5, y + 5), tuple(int(v) for v in random.integers(0, 200, 3)))
    return image.filter(ImageFilter.GaussianBlur(1))


def flat(random):
    return Image.new("RGB", (WIDTH, HEIGHT), tuple(int(v) for v in random.integers(0, 256, 3)))


def sky(random):
    """A gradient."""
    t = (Y / HEIGHT)[..., None]
    return eight_bits((1 - t) * numpy.array([0.25, 0.45, 0.85]) + t * numpy.array([0.9, 0.85, 0.75]))


def landscape(random):
    """Broad shapes and fine texture in colour."""
    base = numpy.stack([0.5 + 0.15 * noise(random, 30) + 0.06 * noise(random, 6) + 0.03 * noise(random, 1.5) for _ in range(3)], 2)
    ridge = HEIGHT * (0.45 + 0.1 * numpy.sin(X / 40) + 0.05 * numpy.sin(X / 11))
    return eight_bits(numpy.where((Y < ridge)[..., None], base * 0.5 + numpy.array([0.25, 0.35, 0.5]), base * numpy.array([0.7, 0.9, 0.4])))


def grey(random):
    return landscape(random).convert("L")


def sepia(random):
    """Faint colour on a grey image."""
    y = numpy.asarray(grey(random), float)[..., None] / 255
    return eight_bits(y * numpy.array([1.03, 1.0, 0.96]) + 0.004 * random.normal(size=(HEIGHT, WIDTH, 3)))


def lines(random):
    image = Image.new("RGB", (2 * WIDTH, 2 * HEIGHT), "white")
    draw = ImageDraw.Draw(image)
    for _ in range(60):
        ends = [int(v) for v in random.uniform(0, 1, 4) * (2 * WIDTH, 2 * HEIGHT, 2 * WIDTH, 2 * HEIGHT)]
        draw.line(ends, tuple(int(v) for v in random.integers(0, 160, 3)), int(random.integers(2, 9)))
    return image.resize((WIDTH, HEIGHT), Image.Resampling.LANCZOS)


def text(random):
    image = Image.new("L", (WIDTH, HEIGHT), 255)
    draw = ImageDraw.Draw(image)
    words = "A picture is a sum of two-dimensional Gaussians, each with a place, a shape and a colour. ".split()
    for row in range(HEIGHT // 13):
        draw.text((6, 4 + 13 * row), " ".join(random.permutation(words)[:11]), 0)
    return image.convert("RGB")


def windows(random):
    """Axis-aligned boxes of one colour, as in a user interface."""
    image = Image.new("RGB", (WIDTH, HEIGHT), (230, 232, 238))
    draw = ImageDraw.Draw(image)
    for _ in range(25):
        x, y = int(random.integers(0, WIDTH)), int(random.integers(0, HEIGHT))
        w, h = int(random.integers(20, 140)), int(random.integers(8, 60))
        draw.rectangle((x, y, x + w, y + h), tuple(int(v) for v in random.integers(40, 256, 3)), (60, 60, 70))
    return image


def cloth(random):
    """Waves in two directions."""
    wave = 0.5 + 0.2 * numpy.sin(0.9 * X + 0.4 * Y + 0.6 * noise(random, 20)) + 0.15 * numpy.sin(0.35 * X - 0.8 * Y)
    return eight_bits(wave[..., None] * numpy.array([0.9, 0.6, 0.5]))


def half_flat(random):
    image = landscape(random)
    image.paste((118, 130, 140), (WIDTH // 2, 0, WIDTH, HEIGHT))
    return image


def sticker(random):
    """Shapes on a transparent background."""
    image = Image.new("RGBA", (2 * WIDTH, 2 * HEIGHT), (0, 0, 0, 0))
    draw = ImageDraw.Draw(image)
    for _ in range(9):
        x, y, r = random.uniform(0, 2 * WIDTH), random.uniform(0, 2 * HEIGHT), random.uniform(30, 120)
        draw.ellipse((x - r, y - r, x + r, y + r), (*(int(v) for v in random.integers(0, 256, 3)), 255))
    return image.resize((WIDTH, HEIGHT), Image.Resampling.LANCZOS)


def opaque_rgba(random):
    image = landscape(random)
    image.putalpha(255)
    return image


SCENES = [stars, bokeh, nebula, dots, flat, sky, landscape, grey, sepia, lines, text, windows, cloth, half_flat, sticker, opaque_rgba]


def draw_all(folder):
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for number, scene in enumerate(SCENES):
        scene(numpy.random.default_rng(number)).save(folder / f"{scene.__name__}.png")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    draw_all(sys.argv[1])
