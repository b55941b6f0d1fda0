#!/usr/bin/env python3
"""Whether quality falls with more bytes or more effort, and whether budgets are used, on drawn images of many kinds.

    sh tests/bench/bench.sh monotone [--gscl build/gscl] [--only NAMES] [--budgets N] [--efforts 0,2,5,9] [--csv FILE]
        [-- OPTIONS OF gscl encode]

The images are those of scenes.py, each with two seeds, and smooth ones.  Budgets grow from 60 to 8000 bytes by factors of 1.3
(with --budgets N, N of them, evenly spread) at effort 5; efforts change at 300 and 1500 bytes.  PSNR is compared with the best
one at fewer bytes, or at a lower effort.  By another seed the PSNR of smooth images differs by half a decibel and more, that
of others by a tenth: a fall counts where it is larger than --tolerance.  A budget counts as unused where less than nine tenths
of it are, unless the image is all but exact (56 dB).  Prints what falls or is unused, and the counts.
"""
import argparse
import pathlib
import tempfile

import numpy
from PIL import Image

import codec
import scenes

EXACT_DB = 56  # where rounding to 8 bits is most of the error
STEP = 1.3  # from one budget to the next
EFFORT_BUDGETS = (300, 1500)


def glow(x, y, random):
    return numpy.exp(-((x - random.uniform(0.3, 0.7)) ** 2 + (y - 0.3) ** 2) / random.uniform(0.02, 0.1))[..., None]


def ramp(x, y, random):
    return 0.2 + 0.4 * x[..., None] * random.uniform(0.2, 1, 3) + 0.4 * y[..., None] * random.uniform(0.2, 1, 3)


def ripple(x, y, random):
    return 0.5 + 0.2 * numpy.cos(random.uniform(3, 12) * (x + 0.5 * y))[..., None] * random.uniform(0.2, 1, 3)


def vignette(x, y, random):
    return (1 - 1.2 * ((x - 0.5) ** 2 + (y - 0.33) ** 2))[..., None] * random.uniform(0.4, 1, 3)


SMOOTH = [glow, ramp, ripple, vignette]


def draw_images(folder):
    """Files of all images.  Smooth ones are named after their function and seed, too."""
    width, height = 192, 128
    x, y = numpy.meshgrid((numpy.arange(width) + 0.5) / width, (numpy.arange(height) + 0.5) / width)
    for seed in (1, 2, 3):
        for draw in SMOOTH:
            image = draw(x, y, numpy.random.default_rng(seed))
            scenes.eight_bits(numpy.broadcast_to(image, (height, width, 3))).save(folder / f"{draw.__name__}_{seed}.png")
    for seed in (1, 2):
        for draw in scenes.SCENES:
            if draw is not scenes.flat:
                draw(numpy.random.default_rng(seed)).save(folder / f"{draw.__name__}_{seed}.png")


def budgets(count):
    sizes = [60]
    while sizes[-1] * STEP <= 8000:
        sizes.append(round(sizes[-1] * STEP))
    places = numpy.linspace(0, len(sizes) - 1, min(count or len(sizes), len(sizes)))
    return [sizes[int(round(place))] for place in places]


def psnr_of(arguments, image, budget, effort, work):
    """Bytes and PSNR of a file."""
    coded = work / "image.gscl"
    _, report = codec.run(arguments.gscl, "encode", image, "-o", coded, "--bytes", budget, "--effort", effort, "--json", "--quiet",
                          *arguments.options)
    return coded.stat().st_size, report["psnr"]


def judge(arguments, image, series, points):
    """A row for each point of a series, of (budget, effort, bytes, PSNR): how far it falls below those before."""
    best, rows = -numpy.inf, []
    for budget, effort, size, psnr in points:
        psnr = 99.0 if psnr is None else psnr  # exact
        rows.append(dict(image=image.stem, series=series, budget=budget, effort=effort, bytes=size, psnr=psnr,
                         fall=max(best - psnr, 0.0), unused=int(size < 0.9 * budget and psnr < EXACT_DB)))
        best = max(best, psnr)
    return rows


def measure_image(arguments, image, work):
    files = [(budget, 5, *psnr_of(arguments, image, budget, 5, work)) for budget in budgets(arguments.budgets)]
    rows = judge(arguments, image, "bytes", files)
    for budget in EFFORT_BUDGETS:
        files = [(budget, effort, *psnr_of(arguments, image, budget, effort, work)) for effort in arguments.efforts.split(",")]
        rows += judge(arguments, image, "effort", files)
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--gscl", default="build/gscl", help="program to measure (default %(default)s)")
    parser.add_argument("--only", default="", help="names of images, separated by commas")
    parser.add_argument("--budgets", type=int, default=0)
    parser.add_argument("--efforts", default=",".join(map(str, range(10))))
    parser.add_argument("--tolerance", type=float, default=0.5, help="decibels (default %(default)s)")
    parser.add_argument("--csv")
    arguments = codec.parse_with_options(parser)
    with tempfile.TemporaryDirectory() as folder:
        draw_images(pathlib.Path(folder))
        rows = codec.measured(arguments, codec.images_of(folder, arguments.only), measure_image)
    wrong = [row for row in rows if row["fall"] > arguments.tolerance or row["unused"]]
    for row in wrong:
        print(f"{row['image']}: {row['budget']} bytes, effort {row['effort']}: {row['psnr']:.2f} dB, {row['fall']:.2f} dB below the "
              f"best before; {row['bytes']} bytes used")
    print(f"{len(rows)} files: {sum(row['fall'] > arguments.tolerance for row in rows)} fall by more than {arguments.tolerance} dB, "
          f"{sum(row['unused'] for row in rows)} leave bytes unused")
    raise SystemExit(bool(wrong))


if __name__ == "__main__":
    main()
