"""Shared by the tests of the package gscl.  POCL_CACHE_DIR should name a folder that no other process uses."""

import pathlib
import sys

import numpy
import pytest

import gscl

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent / "cli"))


def make_picture(width, height, channels=3, dtype=numpy.uint8):
    """A disc on a gradient; the last channel of two or four is a gradient of alpha."""
    y, x = numpy.mgrid[0:height, 0:width]
    inside = (x - width / 2) ** 2 + (y - height / 2) ** 2 < (height / 3) ** 2
    planes = [
        numpy.where(inside, 0.85, 0.1),
        0.2 + 0.6 * y / height,
        numpy.where(inside, 0.2, x / width),
        0.5 + 0.5 * x / width,
    ]
    chosen = {1: [1], 2: [1, 3], 3: [0, 1, 2], 4: [0, 1, 2, 3]}[channels]
    picture = numpy.stack([planes[i] for i in chosen], axis=-1)
    if numpy.dtype(dtype).kind == "u":
        picture = numpy.rint(picture * numpy.iinfo(dtype).max)
    picture = picture.astype(dtype)
    return picture[:, :, 0] if channels == 1 else picture


@pytest.fixture(scope="session")
def picture():
    return make_picture(96, 64)


@pytest.fixture(scope="session")
def data(picture):
    """The picture in a file of at most 400 bytes."""
    return gscl.encode(picture, bytes=400, effort=0)


def psnr(a, b):
    return gscl.compare(a, b).psnr
