"""Pictures as the library takes them: from arrays, from Pillow's images and from files that Pillow reads."""

from __future__ import annotations

import io
import os
import warnings
from dataclasses import dataclass, field
from typing import Any, Union

import numpy
from numpy.typing import NDArray
from PIL import Image, ImageCms, ImageOps

from gscl._binding import ffi, lib
from gscl._errors import InvalidArgumentError
from gscl._names import SAMPLES

Picture = Union[str, "os.PathLike[str]", Image.Image, NDArray[Any]]
"""A path, an image of Pillow, or an array of shape (height, width) or (height, width, channels)."""

# Modes of Pillow that are encoded as they are; others are converted.
_ARRAY_MODES = ("L", "LA", "RGB", "RGBA")


@dataclass
class Source:
    """Samples, and the metadata that the picture came with: "icc_profile", "exif", "xmp"."""

    samples: NDArray[Any]
    metadata: dict[str, bytes] = field(default_factory=dict)


def load(picture: Picture, keep_colours: bool) -> Source:
    """Reads a picture.  Unless its colours are kept as they are, its colour profile is applied: they become sRGB."""
    if isinstance(picture, (str, os.PathLike)):
        with Image.open(picture) as image:
            return _load_image(image, keep_colours)
    if isinstance(picture, Image.Image):
        return _load_image(picture, keep_colours)
    if isinstance(picture, (bytes, bytearray)):
        raise TypeError("expected a path, an image or an array, not bytes: open them with PIL.Image.open(io.BytesIO(data))")
    return Source(_samples(numpy.asarray(picture)))


def _samples(array: NDArray[Any]) -> NDArray[Any]:
    """Converts an array to one that the library reads: rows without gaps, with a known type, of one to four channels."""
    if array.ndim not in (2, 3) or (array.ndim == 3 and not 1 <= array.shape[2] <= 4):
        raise InvalidArgumentError(
            f"an array of shape {array.shape}: expected (height, width) or (height, width, channels) with 1 to 4 channels"
        )
    if array.dtype.kind == "f":
        kind = "float32"
    elif array.dtype.kind == "u" and array.dtype.itemsize <= 2:
        kind = array.dtype.name
    else:
        raise TypeError(f"an array of {array.dtype}: expected uint8, uint16 or floating-point samples in 0..1")
    return numpy.ascontiguousarray(array, dtype=kind)


def _load_image(image: Image.Image, keep_colours: bool) -> Source:
    exif = image.getexif()
    if exif.get(0x0112, 1) != 1:  # orientation
        image = ImageOps.exif_transpose(image)
        exif = image.getexif()
    metadata = {
        "icc_profile": image.info.get("icc_profile"),
        "exif": exif.tobytes().removeprefix(b"Exif\0\0") if len(exif) else None,
        "xmp": _encoded(image.info.get("xmp") or image.info.get("XML:com.adobe.xmp")),
    }
    profile = metadata["icc_profile"]
    if profile and not keep_colours:
        image = _to_srgb(image, profile)
    return Source(_samples_of_image(image), {name: data for name, data in metadata.items() if data})


def _encoded(text: str | bytes | None) -> bytes | None:
    return text.encode() if isinstance(text, str) else text


def _samples_of_image(image: Image.Image) -> NDArray[Any]:
    if image.mode.startswith("I;16"):
        return _samples(numpy.asarray(image))
    if image.mode == "I":  # 16 bits, as far as files have them
        return numpy.asarray(image).clip(0, 65535).astype(numpy.uint16)
    if image.mode == "F":
        return _samples(numpy.asarray(image))
    return numpy.ascontiguousarray(_plain(image))


def _plain(image: Image.Image) -> Image.Image:
    """Converts to grey or RGB with or without alpha, of 8 bits."""
    transparent = "transparency" in image.info or image.mode.endswith(("A", "a"))
    if image.mode in _ARRAY_MODES and not ("transparency" in image.info and image.mode in ("L", "RGB")):
        return image
    grey = image.mode in ("1", "L", "La")
    return image.convert(("LA" if grey else "RGBA") if transparent else ("L" if grey else "RGB"))


def _to_srgb(image: Image.Image, profile: bytes) -> Image.Image:
    """Converts to sRGB.  A picture whose profile cannot be used is taken as sRGB, with a warning."""
    if image.mode.startswith(("I", "F")):
        warnings.warn(f"the colour profile of a picture of mode {image.mode} is ignored", stacklevel=5)
        return image
    image = image if image.mode == "CMYK" else _plain(image)
    alpha = image.getchannel("A") if image.mode in ("LA", "RGBA") else None
    colours = image.convert({"LA": "L", "RGBA": "RGB"}.get(image.mode, image.mode))
    try:
        converted = ImageCms.profileToProfile(
            colours,
            ImageCms.ImageCmsProfile(io.BytesIO(profile)),
            ImageCms.createProfile("sRGB"),
            renderingIntent=ImageCms.Intent.RELATIVE_COLORIMETRIC,
            outputMode="RGB",
            flags=ImageCms.Flags.BLACKPOINTCOMPENSATION,
        )
    except (ImageCms.PyCMSError, OSError, ValueError) as error:
        warnings.warn(f"the colour profile cannot be used, colours are taken as sRGB: {error}", stacklevel=5)
        return image
    assert converted is not None
    if colours.mode == "L":
        converted = converted.convert("L")
    if alpha:
        converted.putalpha(alpha)
    return converted


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
