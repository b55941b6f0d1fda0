"""How other programs draw their fields, from tests/bench/FIELDS.md: slow, and for small pictures.

Each takes the arrays of a checkpoint and the size of the picture, and returns the picture, clamped to 0..1.
"""

import numpy

TILE = 16


def gaussianimage(values, size):
    """The sum of all splats, each cut off below 1/255."""
    if "_cholesky" in values:
        a, b, c = (values["_cholesky"] + (0.5, 0, 0.5)).T
        covariance = numpy.stack([a * a, a * b, b * b + c * c], -1)
    else:
        angle = 2 * numpy.pi / (1 + numpy.exp(-values["_rotation"][:, 0]))
        covariance = _turned(numpy.abs(values["_scaling"] + 0.5), angle)
    centre = (numpy.tanh(values["_xyz"]) + 1) / 2 * size
    return _sum(_weights(centre, covariance, size), values["_features_dc"], values.get("_opacity", numpy.ones(len(centre))))


def gaussianimage_plus(checkpoint, size, color_norm=False):
    values = checkpoint["gs"]
    covariance = values["_cov2d"] + checkpoint["slv_bound"]
    colour = 1 / (1 + numpy.exp(-values["_features_dc"])) if color_norm else values["_features_dc"]
    return _sum(_weights(values["_xyz"], covariance, size), colour, values["_opacity"])


def image_gs(checkpoint, size, topk_norm=True):
    """The mean of the ten splats with the largest weights at a pixel."""
    values = checkpoint["state_dict"]
    weights = _weights(values["xy"] * size, _turned(1 / values["scale"], values["rot"][:, 0]), size)
    if not topk_norm:
        return numpy.clip(numpy.tensordot(weights, values["feat"], (0, 0)), 0, 1)
    if len(weights) > 10:
        weights = numpy.where(weights >= numpy.sort(weights, axis=0)[-10], weights, 0)
    return numpy.clip(numpy.tensordot(weights / (weights.sum(0) + 1e-4), values["feat"], (0, 0)), 0, 1)


def _sum(weights, colour, opacity):
    alpha = numpy.minimum(1, weights * numpy.reshape(opacity, (-1, 1, 1)))
    return numpy.clip(numpy.tensordot(numpy.where(alpha < 1 / 255, 0, alpha), colour, (0, 0)), 0, 1)


def _turned(scale, angle):
    """Covariances: the first axis points along (cos, -sin) of the angle."""
    c, s = numpy.cos(angle), -numpy.sin(angle)
    xx, yy = scale.T**2
    return numpy.stack([c * c * xx + s * s * yy, c * s * (xx - yy), s * s * xx + c * c * yy], -1)


def _weights(centre, covariance, size):
    """Of each splat at each pixel, whose centre has whole numbers: 0 in tiles that three standard deviations do not reach."""
    width, height = size
    y, x = numpy.mgrid[0:height, 0:width]
    drawn = numpy.zeros((len(centre), height, width))
    for i, ((mx, my), (xx, xy, yy)) in enumerate(zip(centre, covariance)):
        dx, dy, determinant = x - mx, y - my, xx * yy - xy * xy
        weight = numpy.exp(-(yy * dx * dx - 2 * xy * dx * dy + xx * dy * dy) / determinant / 2)
        middle = (xx + yy) / 2
        radius = numpy.ceil(3 * numpy.sqrt(middle + numpy.sqrt(max(0.1, middle * middle - determinant))))
        columns, rows = numpy.arange(width) // TILE, numpy.arange(height) // TILE
        in_x = (columns >= numpy.trunc((mx - radius) / TILE)) & (columns < numpy.trunc((mx + radius) / TILE + 1))
        in_y = (rows >= numpy.trunc((my - radius) / TILE)) & (rows < numpy.trunc((my + radius) / TILE + 1))
        drawn[i] = weight * in_x * in_y[:, None]
    return drawn
