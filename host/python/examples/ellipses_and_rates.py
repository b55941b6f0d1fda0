"""Draws what gscl makes of a picture: the decoded picture, its Gaussians as ellipses, and quality against rate.

    python ellipses_and_rates.py PICTURE FIGURE.png [--bytes N] [--effort N]

Needs matplotlib.
"""

import argparse

import matplotlib.pyplot as plt
import numpy
from matplotlib.collections import EllipseCollection
from PIL import Image

import gscl

RATES = 0.02, 0.04, 0.08, 0.125, 0.18, 0.25  # bits per pixel


def show_ellipses(axes, data):
    """Each splat as an ellipse at one standard deviation, in its colour."""
    splats, info = gscl.splats(data), gscl.info(data)
    ellipses = EllipseCollection(
        2 * splats["sigma1"],
        2 * splats["sigma2"],
        numpy.degrees(splats["theta"]),
        units="xy",
        offsets=numpy.column_stack([splats["x"], splats["y"]]),
        offset_transform=axes.transData,
        facecolors=numpy.clip(splats["colour"], 0, 1),
        edgecolors=(0, 0, 0, 0.4),
        linewidths=0.3,
    )
    axes.add_collection(ellipses)
    axes.set(xlim=(0, info.width), ylim=(info.height, 0), aspect="equal", title=f"{info.splats} splats")


def show_rates(axes, picture, effort):
    """PSNR of the decoded file at several rates."""
    pixels = picture.width * picture.height
    files = [gscl.encode(picture, bpp=rate, effort=effort) for rate in RATES]
    rates = [8 * len(file) / pixels for file in files]
    axes.plot(rates, [file.report.psnr for file in files], "o-")
    axes.set(xlabel="bits per pixel", ylabel="PSNR, dB", title="quality against rate")
    axes.grid(alpha=0.3)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("picture")
    parser.add_argument("figure")
    parser.add_argument("--bytes", type=int)
    parser.add_argument("--effort", type=int, default=5)
    arguments = parser.parse_args()

    with Image.open(arguments.picture) as image:
        picture = image.convert("RGB")
    data = gscl.encode(picture, bytes=arguments.bytes, effort=arguments.effort)
    report = data.report
    print(f"{len(data)} bytes, {report.psnr:.2f} dB, {report.splats} splats, {report.seconds:.1f} s")

    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(15, 4), width_ratios=(3, 3, 2), layout="constrained")
    left.imshow(gscl.decode(data))
    left.set(title=f"decoded from {len(data)} bytes, {report.psnr:.2f} dB")
    show_ellipses(middle, data)
    show_rates(right, picture, arguments.effort)
    for axes in left, middle:
        axes.set(xticks=[], yticks=[])
    figure.savefig(arguments.figure, dpi=80)


if __name__ == "__main__":
    main()
