#!/usr/bin/env python3
"""Fits fields of splats by the conventions of other programs, and packs them: bytes at the quality of the field.

    python fields.py /path/to/kodak/kodim0[57].png --splats 500 2000 10000 --fits fits > table.md

FIELDS.md has the conventions, and results.  It needs the package gscl, NumPy and Pillow.  The fitter is short and of this project; it
takes far fewer steps than those programs, so that the PSNR of its fields is lower than what they publish.
"""

import argparse
import math
import os
import pathlib
import sys
import time
from concurrent.futures import ProcessPoolExecutor

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # products of small matrices

import gscl
import numpy
from PIL import Image

TILE = 16
"""Pixels of a side of a tile: a splat draws in those that the square of its radius, three standard deviations, meets."""
TOP_K, EPSILON = 10, 1e-4  # of Image-GS
LEAST_ALPHA = 1 / 255  # of GaussianImage

# ---- The splats that are fitted --------------------------------------------------------------------
# A row of shape is ln p, t, ln s: for the distance d from the centre, q = (p dx)^2 / 2 + (t p dx + s dy)^2 / 2.


def start(picture, count, blend, random):
    """Splats that are denser where the picture changes, as large as their distance, with its colours."""
    height, width, _ = picture.shape
    grey = picture.mean(2)
    change = numpy.hypot(*numpy.gradient(grey))
    density = 0.5 * change / change.mean() + 0.5
    density *= count / density.sum()
    at = random.choice(grey.size, count, p=density.ravel() / density.sum())
    centre = numpy.stack([at % width, at // width], -1) + random.uniform(-0.5, 0.5, (count, 2))
    sigma = 0.5 / numpy.sqrt(density.ravel()[at])
    shape = numpy.stack([-numpy.log(sigma), numpy.zeros(count), -numpy.log(sigma)], -1)
    overlap = 2 * math.pi * 0.25 if blend == "sum" else 1
    return [a.astype("f4") for a in (centre, shape, picture.reshape(-1, 3)[at] / overlap)]


def conic(shape):
    p, s = numpy.exp(shape[:, 0]), numpy.exp(shape[:, 2])
    r = shape[:, 1] * p
    return p, r, s, p * p + r * r, r * s, s * s


def cholesky(shape):
    p, r, s, *_ = conic(shape.astype("f8"))
    return numpy.stack([1 / p, -r / (p * s), 1 / s], -1)


def pairs_of(centre, shape, width, height):
    """Splats and tiles that meet, ordered by tile, and where each tile begins."""
    factor = cholesky(shape)
    xx, xy, yy = factor[:, 0] ** 2, factor[:, 0] * factor[:, 1], factor[:, 1] ** 2 + factor[:, 2] ** 2
    middle = (xx + yy) / 2
    radius = numpy.ceil(3 * numpy.sqrt(middle + numpy.sqrt(numpy.maximum(0.1, middle**2 - (xx * yy - xy * xy)))))
    tiles = numpy.array([-(-width // TILE), -(-height // TILE)])
    first = numpy.clip(numpy.trunc((centre - radius[:, None]) / TILE), 0, tiles).astype(int)
    last = numpy.clip(numpy.trunc((centre + radius[:, None]) / TILE + 1), 0, tiles).astype(int)
    columns, rows = (numpy.maximum(last - first, 0)).T
    owner = numpy.repeat(numpy.arange(len(centre)), columns * rows)
    within = numpy.arange(len(owner)) - numpy.repeat(numpy.cumsum(columns * rows) - columns * rows, columns * rows)
    tile = (first[owner, 1] + within // columns[owner]) * tiles[0] + first[owner, 0] + within % columns[owner]
    order = numpy.argsort(tile, kind="stable")
    return owner[order], tile[order], numpy.searchsorted(tile[order], numpy.arange(tiles.prod() + 1)), tiles


def evaluate(parameters, blend, picture, gradients=True):
    """The field's picture, and the gradients of the sum of its squared differences, halved, to a picture."""
    centre, shape, colour = parameters
    height, width, _ = picture.shape
    owner, tile, begin, tiles = pairs_of(centre, shape, width, height)
    p, r, s, a, b, c = (values[owner].astype("f4") for values in conic(shape))
    corner = numpy.stack([tile % tiles[0], tile // tiles[0]], -1) * TILE
    mx, my = (centre[owner] - corner - TILE / 2).T.astype("f4")
    factors = numpy.stack(
        [a / 2, b, c / 2, -(a * mx + b * my), -(c * my + b * mx), a * mx * mx / 2 + b * mx * my + c * my * my / 2], -1
    )
    v, u = (numpy.mgrid[0:TILE, 0:TILE].reshape(2, -1) - TILE / 2).astype("f4")
    monomials = numpy.stack([u * u, u * v, v * v, u, v, numpy.ones_like(u)])
    drawn = numpy.zeros((tiles[1] * TILE, tiles[0] * TILE, 3), "f4")
    target = numpy.zeros_like(drawn)
    target[:height, :width] = picture
    inside = numpy.zeros(drawn.shape[:2], "f4")
    inside[:height, :width] = 1
    moments, colours = numpy.zeros((len(owner), 6), "f4"), numpy.zeros((len(owner), 3), "f4")
    for number in range(tiles.prod()):
        rows = slice(begin[number], begin[number + 1])
        y, x = number // tiles[0] * TILE, number % tiles[0] * TILE
        if rows.start == rows.stop:
            continue
        own = colour[owner[rows]]
        weight = numpy.exp(-(factors[rows] @ monomials))
        if blend == "sum":
            weight[weight < LEAST_ALPHA] = 0
            part = weight.T @ own
        else:
            if len(own) > TOP_K:
                weight[weight < numpy.partition(weight, len(own) - TOP_K, axis=0)[len(own) - TOP_K]] = 0
            total = weight.sum(0) + numpy.float32(EPSILON)
            part = (weight.T @ own) / total[:, None]
        drawn[y : y + TILE, x : x + TILE] = part.reshape(TILE, TILE, 3)
        if not gradients:
            continue
        error = (part - target[y : y + TILE, x : x + TILE].reshape(-1, 3)) * inside[y : y + TILE, x : x + TILE].reshape(-1, 1)
        if blend == "sum":
            slope = own @ error.T
        else:
            slope = (own @ error.T - (part * error).sum(1)) / total
            error = error / total[:, None]
        colours[rows] = weight @ error
        slope *= -weight
        moments[rows] = slope @ monomials.T
    drawn = drawn[:height, :width]
    if not gradients:
        return drawn, None
    xx, xy, yy, dx, dy, one = moments.T
    sx, sy = dx - mx * one, dy - my * one
    ga, gb, gc = (xx - 2 * mx * dx + mx * mx * one) / 2, xy - mx * dy - my * dx + mx * my * one, (yy - 2 * my * dy + my * my * one) / 2
    gr = 2 * r * ga + s * gb
    slopes = [-(a * sx + b * sy), -(c * sy + b * sx), 2 * p * p * ga + r * gr, p * gr, s * (r * gb + 2 * s * gc), *colours.T]
    sums = numpy.stack([numpy.bincount(owner, value, len(centre)) for value in slopes], -1)
    return drawn, [sums[:, :2], sums[:, 2:5], sums[:, 5:]]


def fit(picture, count, blend, steps, seed=1):
    """Adam, with steps that end at a tenth of where they begin."""
    parameters = start(picture, count, blend, numpy.random.default_rng(seed))
    size = numpy.exp(-parameters[1][:, :1])
    rates = [0.06 * size, 0.03, 0.01]
    first, second = ([numpy.zeros(value.shape) for value in parameters] for _ in range(2))
    for step in range(1, steps + 1):
        _, slopes = evaluate(parameters, blend, picture)
        for i, slope in enumerate(slopes):
            first[i] += 0.1 * (slope - first[i])
            second[i] += 0.01 * (slope * slope - second[i])
            change = first[i] / (1 - 0.9**step) / (numpy.sqrt(second[i] / (1 - 0.99**step)) + 1e-12)
            parameters[i] = (parameters[i] - rates[i] * 0.1 ** (step / steps) * change).astype("f4")
        parameters[1][:, [0, 2]] = numpy.minimum(parameters[1][:, [0, 2]], math.log(2))
    return parameters


# ---- As these programs keep them -------------------------------------------------------------------


def gaussianimage(parameters, size):
    """Arrays of a checkpoint of GaussianImage, and their bytes in its codec: 56 bits a splat, and its code books."""
    centre, shape, colour = parameters
    places = numpy.clip(2 * (centre / size) - 1, -0.999999, 0.999999)
    values = {"_xyz": numpy.arctanh(places), "_cholesky": cholesky(shape) - (0.5, 0, 0.5), "_features_dc": colour}
    return values, 7 * len(centre) + 2 * 8 * 3 * 4 + 6 * 4


def image_gs(parameters, size):
    """Arrays of a checkpoint of Image-GS, and their bytes with the 16 bits of its configuration."""
    centre, shape, colour = parameters
    factor = cholesky(shape)
    xx, xy, yy = factor[:, 0] ** 2, factor[:, 0] * factor[:, 1], factor[:, 1] ** 2 + factor[:, 2] ** 2
    half, tilt = numpy.hypot((xx - yy) / 2, xy), numpy.arctan2(xy, (xx - yy) / 2) / 2
    larger = (xx + yy) / 2 + half
    sigma = numpy.sqrt(numpy.stack([larger, (xx * yy - xy * xy) / larger], -1))
    return {"xy": centre / size, "scale": 1 / sigma, "rot": -tilt[:, None], "feat": colour}, 16 * len(centre)


PROGRAMS = {
    "GaussianImage": ("sum", gaussianimage, gscl.fields.load_gaussianimage),
    "Image-GS": ("top-k", image_gs, gscl.fields.load_image_gs),
}

# ---- Rows of the table -----------------------------------------------------------------------------

HEAD = (
    "| picture | convention | splats | own dB | drawn by gscl dB | finest codes dB | to own picture: drawn by gscl dB | finest codes dB "
    "| with passes dB | packed to dB | 16-bit floats B | its codec B "
    "| pack B | % | s | with passes B | % | s | passes, refine 3 B | % | s | encode B "
    "| own less 0.1 dB, passes B | % | s | refine 3 B | % | s | left out | divided | changed |"
)


def psnr(a, b):
    return -10 * math.log10(numpy.mean((numpy.clip(a, 0, 1).astype("f8") - b) ** 2))


def try_pack(field, picture, target, floats, **settings):
    """Cells of a way to pack, and the report of what was written."""
    begin = time.perf_counter()
    try:
        packed = gscl.pack(field, psnr=target, reference=picture, device="host", tolerance=1, **settings)
    except gscl.TargetUnreachableError as error:
        print(f"  {settings}: {error}", file=sys.stderr)
        return ["not reached", "", f"{time.perf_counter() - begin:.1f}"], None
    return [f"{len(packed):,}", f"{100 * len(packed) / floats:.1f}", f"{time.perf_counter() - begin:.1f}"], packed.report


def nearness(field, own_picture):
    """PSNR to the program's own picture: of the field by gscl, of the finest codes, and of those that passes choose, which take
    about as many bytes."""
    settings = {"reference": numpy.ascontiguousarray(own_picture, "f4"), "device": "host", "tolerance": 1}
    finest = gscl.pack(field, **settings)
    passed = gscl.pack(field, bytes=int(1.3 * len(finest)), **settings)
    return finest.report.field_psnr, finest.report.psnr, passed.report.psnr


def row(path, program, count, options):
    blend, to_checkpoint, load = PROGRAMS[program]
    picture8 = numpy.asarray(Image.open(path).convert("RGB"))
    picture = picture8.astype("f4") / 255
    size = picture8.shape[1::-1]
    kept = options.fits / f"{path.stem}-{program}-{count}-{options.steps}.npz"
    if kept.exists():
        parameters = [numpy.load(kept)[name] for name in ("centre", "shape", "colour")]
    else:
        parameters = fit(picture, count, blend, options.steps)
        options.fits.mkdir(parents=True, exist_ok=True)
        numpy.savez(kept, **dict(zip(("centre", "shape", "colour"), parameters)))
    own_picture = numpy.clip(evaluate(parameters, blend, picture, gradients=False)[0], 0, 1)
    own = psnr(own_picture, picture)
    values, bits = to_checkpoint(parameters, size)
    field = load(values, size=size)
    finest = gscl.pack(field, reference=picture8, device="host", tolerance=1).report
    floats, target = 16 * count, min(own, finest.psnr) - 0.1
    cells = [path.stem, program, f"{count:,}", *(f"{value:.2f}" for value in (own, finest.field_psnr, finest.psnr))]
    cells += [f"{value:.1f}" for value in nearness(field, own_picture)]
    cells += [f"{target:.2f}", f"{floats:,}", f"{bits:,}"]
    for settings in ({"passes": False}, {"passes": True}, {"passes": True, "refine": 3}):
        cells += try_pack(field, picture8, target, floats, **settings)[0]
    begin = time.perf_counter()
    encoded = gscl.encode(picture8, psnr=target, effort=options.effort, device="host")
    cells += [f"{len(encoded):,} ({time.perf_counter() - begin:.0f} s)"]
    for refine in (0, 3):
        cells += try_pack(field, picture8, own - 0.1, floats, refine=refine)[0]
    cells += [f"{100 * value / count:.1f} %" for value in (finest.outside, finest.divided, finest.changed)]
    if finest.changed:
        cells[-1] += f" ({finest.changed_psnr:.1f} dB{', refused' if finest.changed_psnr < 40 else ''})"
    return "| " + " | ".join(cells) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("pictures", nargs="+", type=pathlib.Path)
    parser.add_argument("--splats", nargs="+", type=int, default=[500, 2000, 10000])
    parser.add_argument("--programs", nargs="+", choices=PROGRAMS, default=list(PROGRAMS))
    parser.add_argument("--steps", type=int, default=400, help="of the fitter (default: 400)")
    parser.add_argument("--effort", type=int, default=3, help="of gscl encode (default: 3)")
    parser.add_argument("--fits", type=pathlib.Path, default=pathlib.Path("fits"), help="folder that keeps fitted fields")
    parser.add_argument("--workers", type=int, default=1, help="pictures at the same time: times are then not exact")
    options = parser.parse_args()
    print(HEAD, "|---" * (HEAD.count("|") - 1) + "|", sep="\n", flush=True)
    work = [(path, program, count) for count in options.splats for program in options.programs for path in options.pictures]
    with ProcessPoolExecutor(options.workers) as pool:
        for done in [pool.submit(row, *item, options) for item in work]:
            print(done.result(), flush=True)


if __name__ == "__main__":
    main()
