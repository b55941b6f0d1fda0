"""Pictures as the library takes them: from arrays, from Pillow's images and from files that Pillow reads."""

from __future__ import annotations

import os
import warnings
from dataclasses import dataclass, field
from typing import Any, Literal, Union

import numpy
from numpy.typing import NDArray
from PIL import Image

from gscl._binding import ffi, lib
from gscl._colours import Colours, can_be_stored, colours_of, inks_to_srgb, require_conversion, to_srgb
from gscl._errors import InvalidArgumentError
from gscl._files import BinaryFile, is_file, with_seek
from gscl._formats import checked
from gscl._metadata import read_metadata, turned_upright
from gscl._names import SAMPLES

Picture = Union[str, "os.PathLike[str]", BinaryFile, Image.Image, NDArray[Any]]
"""A path, an open binary file, an image of Pillow, or an array of shape (height, width) or (height, width, channels)."""

# Modes of Pillow that are encoded as they are; others are converted.
_ARRAY_MODES = ("L", "LA", "RGB", "RGBA")

# A tag of TIFF and its value; Pillow makes positives of such samples of 8 bits only.
_PHOTOMETRIC, _WHITE_IS_ZERO = 262, 0


@dataclass
class Source:
    """Samples, and the metadata that the picture came with: "icc_profile", "exif", "xmp", "cicp"."""

    samples: NDArray[Any]
    metadata: dict[str, Any] = field(default_factory=dict)


Keep = Literal["none", "own", "given"]
"""Colours that are not converted to sRGB: none, those that a profile or code points of the picture describe, or all,
because the caller says what they are."""


def load(picture: Picture, keep: Keep = "none") -> Source:
    """Reads a picture."""
    if isinstance(picture, Image.Image):
        return _load_image(picture, keep)
    if isinstance(picture, (str, os.PathLike)) or is_file(picture):
        with Image.open(picture if isinstance(picture, (str, os.PathLike)) else with_seek(picture)) as image:
            return _load_image(image, keep)
    if isinstance(picture, (bytes, bytearray, memoryview)):
        raise TypeError("expected a path, an open file, an image or an array, not bytes: pass io.BytesIO(data)")
    return Source(_samples(numpy.asarray(picture)))


# ---- Samples -------------------------------------------------------------------------------------


def _samples(array: NDArray[Any]) -> NDArray[Any]:
    """Converts an array to one that the library reads: rows without gaps, with a known type, of one to four channels."""
    if array.ndim not in (2, 3) or (array.ndim == 3 and not 1 <= array.shape[2] <= 4):
        raise InvalidArgumentError(
            f"an array of shape {array.shape}: expected (height, width) or (height, width, channels) with 1 to 4 channels"
        )
    if array.dtype.kind == "f":
        kind = "float32"
        _warn_of_clamping(array)
    elif array.dtype.kind == "u" and array.dtype.itemsize <= 2:
        kind = array.dtype.name
    else:
        raise TypeError(f"an array of {array.dtype}: expected uint8, uint16 or floating-point samples in 0..1")
    return numpy.ascontiguousarray(array, dtype=kind)


def _warn_of_clamping(array: NDArray[Any]) -> None:
    """Warns of finite samples that the encoder clamps, beyond the errors of conversions.  It refuses infinite ones."""
    tolerance = 1 / 512
    outside = numpy.isfinite(array) & ((array < -tolerance) | (array > 1 + tolerance))
    if count := int(outside.sum()):
        warnings.warn(
            f"{count} samples lie outside 0..1 and are clamped; scale them first if they matter", stacklevel=5
        )


def _samples_of_image(image: Image.Image) -> NDArray[Any]:
    samples = numpy.asarray(image)
    if image.mode.startswith("I;16"):
        samples = samples.astype(numpy.uint16)
        return _with_transparent_grey(samples, image.info.get("transparency"))
    if image.mode == "I":
        low, high = int(samples.min()), int(samples.max())
        if low < 0 or high > 65535:
            raise InvalidArgumentError(f"an image of mode I with samples of {low} to {high}; 0 to 65535 are expected")
        return _with_transparent_grey(samples.astype(numpy.uint16), image.info.get("transparency"))
    if image.mode == "F":
        return _samples(samples)
    return numpy.asarray(_plain(image))


def _with_transparent_grey(samples: NDArray[Any], grey: int | None) -> NDArray[Any]:
    """Appends alpha where one grey of 16 bits is transparent."""
    if grey is None:
        return samples
    return numpy.stack([samples, numpy.where(samples == grey, 0, 65535).astype(numpy.uint16)], -1)


def _plain(image: Image.Image) -> Image.Image:
    """Converts to grey or RGB with or without alpha, of 8 bits."""
    if image.mode == "LAB":
        raise InvalidArgumentError("a picture of Lab colours; convert it to RGB first")
    transparent = "transparency" in image.info or image.mode.endswith(("A", "a"))
    if image.mode in _ARRAY_MODES and not ("transparency" in image.info and image.mode in ("L", "RGB")):
        return image
    grey = image.mode in ("1", "L", "La")
    return image.convert(("LA" if grey else "RGBA") if transparent else ("L" if grey else "RGB"))


# ---- Images of Pillow ------------------------------------------------------------------------------


def _load_image(image: Image.Image, keep: Keep) -> Source:
    metadata = read_metadata(image)
    colours = colours_of(image, metadata.names_adobe_rgb)
    image = checked(image)
    upright = turned_upright(image, metadata.orientation)
    if image.mode == "CMYK":
        samples = inks_to_srgb(upright, colours)
        return Source(samples, metadata.blocks(Colours()))
    samples = _corrected(image, _samples_of_image(upright))
    if keep == "given" or (keep == "own" and can_be_stored(colours, samples)):
        return Source(numpy.ascontiguousarray(samples), metadata.blocks(colours))
    require_conversion(colours)
    if colours != Colours():
        samples = to_srgb(samples, colours)
        metadata.set_srgb()
    return Source(numpy.ascontiguousarray(samples), metadata.blocks(Colours()))


def _corrected(image: Image.Image, samples: NDArray[Any]) -> NDArray[Any]:
    """Makes of samples what the file says, where Pillow does not."""
    tags = getattr(image, "tag_v2", None)
    if tags is not None and tags.get(_PHOTOMETRIC) == _WHITE_IS_ZERO and samples.dtype != numpy.uint8:
        return 1 - samples if samples.dtype.kind == "f" else 65535 - samples
    return samples


def to_struct(samples: NDArray[Any]) -> tuple[Any, Any]:
    """A gscl_image of an array, and the owner of its pixels, which must live as long."""
    owner = ffi.from_buffer(samples)
    image = ffi.new("gscl_image *")
    image.height, image.width = samples.shape[:2]
    image.channels = samples.shape[2] if samples.ndim == 3 else 1
    image.sample = SAMPLES[samples.dtype.name]
    image.pixels = owner
    return image, owner


def from_struct(image: Any) -> NDArray[Any]:
    """The array of a gscl_image that the library allocated; its pixels are released with the array."""
    name = next(name for name, sample in SAMPLES.items() if sample == image.sample)
    pixels = ffi.gc(image.pixels, lib.gscl_free)
    size = image.height * image.width * image.channels * numpy.dtype(name).itemsize
    samples = numpy.frombuffer(ffi.buffer(pixels, size), dtype=name)
    shape = (image.height, image.width) if image.channels == 1 else (image.height, image.width, image.channels)
    return samples.reshape(shape)
