"""Decoding, and comparing pictures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy
from numpy.typing import DTypeLike, NDArray

from gscl._binding import ffi, lib
from gscl._devices import HOST, context_on
from gscl._errors import ConflictError, Error, InvalidArgumentError, NoPlatformError, assign, check
from gscl._images import Picture, from_struct, load, to_struct
from gscl._inspect import Content, File, inspect, read
from gscl._names import SAMPLES
from gscl._progress import ProgressCallback, call, interruptible
from gscl._records import Record

# Pixels up to which a decode takes the device "host" where the default device is another one.  A GPU draws large pictures
# sooner, but its kernels must be compiled once, and a small picture is drawn before they are found in a cache.
HOST_PIXELS = 3_000_000


def decode(
    file: File,
    *,
    size: tuple[int, int] | None = None,
    crop: tuple[int, int, int, int] | None = None,
    dtype: DTypeLike | None = None,
    out: NDArray[Any] | None = None,
    premultiplied: bool = False,
    partial: bool = False,
    bare: bool = False,
    max_pixels: int | None = None,
    max_work: int | None = None,
    progress: ProgressCallback | None = None,
    device: str | None = None,
    threads: int = 0,
) -> NDArray[Any]:
    """Decodes a file to an array of shape (height, width) if it is grey, else (height, width, channels): grey and alpha,
    RGB or RGBA.

    file: the bytes of a gscl file, as encode returns them, its path, or an open binary file; also a list of packets, or a list or
        tuple of the bytes of packets, of which those are drawn that have come, and those that repair packets replace.
    size: width and height at which the whole picture is drawn; None for the encoded size.
    crop: x, y, width and height of the rectangle of the drawn picture to return.
    dtype: uint8; uint16; or a floating-point type for samples in 0..1, which are computed as float32 and not rounded to
        integers.  None for that of `out`, else for uint8 or uint16, as the source was.
    out: an array to write the pixels into, and to return: of the shape of the result, of a type that `dtype` can be, with any
        strides.  It is not touched where there is an error.
    premultiplied: whether to multiply colours by alpha.
    partial: whether the file may be cut off: draws the splats that its bytes hold.
    bare: whether the file was encoded with `bare`, which its bytes do not tell.
    max_pixels, max_work: limits for files from strangers: pixels to return, and evaluations of a splat at a pixel (a core
        does about 5e8 a second).  LimitError is raised before memory is allocated.
    progress: called after each part of the picture; returns False to cancel, which raises CancelledError.
    device: "host", which needs no OpenCL; "P.D" or a part of the name of an OpenCL device; None for "host", or for pictures of
        more than three megapixels the default device of encode, which is "host" on machines without a GPU.
    threads: of the device "host"; 0 for as many as the process may run.  Samples do not depend on it.

    Raises a subclass of gscl.Error, or OSError.  The interpreter's lock is released while the library works.  An interrupt
    (Ctrl-C) in the main thread stops the decode with KeyboardInterrupt.
    """
    settings = ffi.new("gscl_decode_settings *")
    lib.gscl_decode_settings_init(settings, ffi.sizeof("gscl_decode_settings"))
    if size is not None:
        _assign_all(settings, "size", size, ("width", "height"), positive=(0, 1))
    if crop is not None:
        _assign_all(settings, "crop", crop, ("crop_x", "crop_y", "crop_width", "crop_height"), positive=(2, 3))
    kind = _sample_type(dtype, out)
    if kind is not None:
        settings.sample = SAMPLES["float32" if kind.kind == "f" else kind.name]
    for name, limit in {"max_pixels": max_pixels, "max_work": max_work}.items():
        if limit is not None:
            _assign_all(settings, name, (limit,), (name,), positive=(0,))
    settings.premultiplied, settings.partial, settings.bare = premultiplied, partial, bare
    content = read(file, bare)
    if out is not None:
        _require_shape(out, _shape(content, settings))
    if device is None and _pixels(content, settings) <= HOST_PIXELS:
        device = HOST

    def work(progress: ProgressCallback | None) -> NDArray[Any]:
        try:
            return _draw(content, settings, device, threads, progress)
        except NoPlatformError:
            if device is not None:
                raise
            return _draw(content, settings, HOST, threads, progress)

    pixels = interruptible(work, progress)
    if out is not None:
        numpy.copyto(out, pixels)
        return out
    return pixels if kind is None else pixels.astype(kind, copy=False)


def _sample_type(dtype: DTypeLike | None, out: NDArray[Any] | None) -> numpy.dtype[Any] | None:
    """The type of the samples to return; None for that of the source."""
    kind = None if dtype is None else _supported("dtype", numpy.dtype(dtype))
    if out is None:
        return kind
    if not isinstance(out, numpy.ndarray):
        raise TypeError(f"out: expected an array of NumPy, not {type(out).__name__}")
    if not out.flags.writeable:
        raise InvalidArgumentError("out: the array is read-only: expected one that can be written")
    if kind is not None and kind != out.dtype:
        raise ConflictError(f"dtype is {kind}, and out is an array of {out.dtype}; leave dtype out, or give the same")
    return _supported("out", out.dtype)


def _supported(argument: str, kind: numpy.dtype[Any]) -> numpy.dtype[Any]:
    if kind.kind != "f" and kind.name not in SAMPLES:
        raise InvalidArgumentError(f"{argument}: {kind}: expected uint8, uint16 or a floating-point type")
    return kind


def _require_shape(out: NDArray[Any], shape: tuple[int, ...]) -> None:
    if out.shape != shape:
        raise InvalidArgumentError(f"out: an array of shape {out.shape}: expected {shape} for this picture")


def _shape(content: Content, settings: Any) -> tuple[int, ...]:
    """Of the result."""
    info = inspect(lib.gscl_probe, content, settings.bare)
    height = settings.crop_height or settings.height or info.height
    width = settings.crop_width or settings.width or info.width
    return (height, width) if info.channels == 1 else (height, width, info.channels)


def _assign_all(
    settings: Any, argument: str, values: tuple[int, ...], fields: tuple[str, ...], positive: tuple[int, ...]
) -> None:
    """Sets fields to numbers, of which some must not be 0, because 0 is a default of the library."""
    if len(values) != len(fields) or any(values[i] < 1 for i in positive):
        raise InvalidArgumentError(f"{argument}: {values}: expected {len(fields)} numbers, and sizes of at least 1")
    for name, value in zip(fields, values):
        assign(settings, name, value, argument)


def _pixels(content: Content, settings: Any) -> int:
    """Pixels to draw; 0 for a file that cannot be read, which decoding refuses with its message."""
    if settings.crop_width:
        return int(settings.crop_width * settings.crop_height)
    if settings.width:
        return int(settings.width * settings.height)
    try:
        return int(inspect(lib.gscl_probe, content, settings.bare).pixels)
    except Error:
        return 0


def _draw(
    content: Content, settings: Any, device: str | None, threads: int, progress: ProgressCallback | None
) -> NDArray[Any]:
    image = ffi.new("gscl_image *")
    with context_on(device, threads) as context:

        def draw() -> int:
            return int(lib.gscl_decode(context, content.buffer, content.size, settings, image))

        check(call(settings, progress, draw), context, content.name)
    return from_struct(image)


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(Record):
    """How far two pictures differ."""

    mse: float
    """Mean squared error over all channels, samples in 0..255."""
    psnr: float
    """dB; infinite for equal pictures."""
    ssim: float
    ms_ssim: float
    max_difference: float
    """Of samples in 0..255."""
    ssimulacra2: float
    """SSIMULACRA 2.1 of b as a version of a: 100 for equal pictures."""


def compare(a: Picture, b: Picture) -> Comparison:
    """Compares two pictures of equal size and channels.  Measures that need more pixels than there are become NaN.
    Raises a subclass of gscl.Error."""
    (first, owner), (second, other) = (to_struct(load(picture).samples) for picture in (a, b))
    found = ffi.new("gscl_comparison *", {"struct_size": ffi.sizeof("gscl_comparison")})
    check(lib.gscl_compare(first, second, found))
    del owner, other
    return Comparison(found.mse, found.psnr, found.ssim, found.ms_ssim, found.max_difference, found.ssimulacra2)
