"""The pictures that the sweep writes, and how pictures are compared."""

from dataclasses import dataclass

import numpy

WIDTH, HEIGHT = 37, 21  # no multiples of a tile, a block or a byte of single bits


def picture(channels, levels=255, width=WIDTH, height=HEIGHT):
    """Integers 0..levels of shape (height, width, channels).  Every corner, channel and direction differs, so that a turn, a
    wrong order of channels and a negative show.  Alpha, the last of 2 or 4 channels, reaches neither 0 nor opaque: below
    0.3 a premultiplied colour of 8 bits would be coarser than the tolerance."""
    y, x = numpy.mgrid[0:height, 0:width]
    u, v = x / (width - 1), y / (height - 1)
    red = 0.1 + 0.8 * u
    green = 0.9 - 0.7 * v
    blue = 0.2 + 0.35 * u + 0.35 * v
    alpha = 0.35 + 0.3 * u + 0.3 * v
    planes = {
        1: (red * 0.6 + green * 0.4,),
        2: (red * 0.6 + green * 0.4, alpha),
        3: (red, green, blue),
        4: (red, green, blue, alpha),
    }[channels]
    return numpy.rint(numpy.stack(planes, -1) * levels).astype(numpy.int64)


def indexed(colours, channels=3, width=WIDTH, height=HEIGHT):
    """A palette of integers 0..255 of shape (colours, channels), and indices of shape (height, width) that use all of it."""
    y, x = numpy.mgrid[0:height, 0:width]
    indices = (x * 3 + y * 5 + x * y // 7) % colours
    n = numpy.arange(colours)
    planes = [(40 + 67 * n) % 256, (200 + 31 * n) % 256, (90 + 113 * n) % 256, 100 + 155 * n // max(1, colours - 1)]
    return numpy.stack(planes[:channels], -1), indices


def scaled(samples, levels=255):
    """Integers as samples of 0..1."""
    return numpy.asarray(samples, dtype=float) / levels


def srgb_to_linear(v):
    return numpy.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)


def linear_to_srgb(v):
    v = numpy.maximum(v, 0)
    return numpy.where(v <= 0.0031308, 12.92 * v, 1.055 * v ** (1 / 2.4) - 0.055)


def premultiplied(samples):
    """Straight samples with the colours multiplied by alpha."""
    out = numpy.array(samples, dtype=float)
    if out.shape[2] in (2, 4):
        out[..., :-1] *= out[..., -1:]
    return out


def straight(samples):
    """Samples whose colours are multiplied by alpha, divided by it."""
    alpha = samples[..., -1:]
    return numpy.concatenate([samples[..., :-1] / numpy.where(alpha > 0, alpha, 1), alpha], -1)


@dataclass
class Sample:
    """A file, and what it shows: straight samples of 0..1 on the curve of sRGB, of shape (height, width, channels).  None
    for what shows no picture that gscl could take."""

    format: str
    variant: str
    writer: str  # "bytes": by hand
    suffix: str
    data: bytes
    expected: numpy.ndarray | None
    tolerance: float = 1 / 255


def as_channels(samples, channels):
    """Grey as RGB and without alpha as opaque, where the other picture has these channels."""
    colours, alpha = (samples[..., :-1], samples[..., -1:]) if samples.shape[2] in (2, 4) else (samples, None)
    if channels >= 3 and colours.shape[2] == 1:
        colours = numpy.repeat(colours, 3, axis=2)
    if channels in (2, 4) and alpha is None:
        alpha = numpy.ones(colours.shape[:2] + (1,))
    return colours if alpha is None else numpy.concatenate([colours, alpha], axis=2)


def difference(got, expected):
    """The largest difference of two pictures, colours multiplied by alpha; infinite for other sizes."""
    if got.shape[:2] != expected.shape[:2] or got.shape[2] > 4:
        return float("inf")
    a, b = as_channels(got, expected.shape[2]), as_channels(expected, got.shape[2])
    if a.shape != b.shape:  # one has alpha, the other colours: make both RGBA
        a, b = as_channels(a, 4), as_channels(b, 4)
    return float(numpy.abs(premultiplied(a) - premultiplied(b)).max())
