"""All files of the sweep."""

import re

import bmp
import colours
import dds
import exr
import gif
import hdr
import heif
import ico
import imagemagick
import jpeg
import jpeg2000
import pnm
import png
import psd
import sgi
import tga
import tiff
import webp

MODULES = (
    colours,
    png,
    jpeg,
    webp,
    heif,
    jpeg2000,
    gif,
    tiff,
    exr,
    hdr,
    bmp,
    ico,
    tga,
    pnm,
    psd,
    sgi,
    dds,
    imagemagick,
)


def all_samples():
    """Yields each sample, and whether gscl refuses it.  What gscl refuses must be named by the pattern REFUSED of its module,
    so that no variant is lost without notice."""
    for module in MODULES:
        refused = getattr(module, "REFUSED", None)
        for sample in module.samples():
            yield sample, bool(refused and re.search(refused, f"{sample.format}, {sample.variant}"))
