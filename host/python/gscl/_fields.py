"""Fields: splats as arrays, of gscl files and of other programs."""

from __future__ import annotations

import builtins
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy
from numpy.typing import ArrayLike, NDArray

from gscl._binding import ffi, lib
from gscl._devices import context_on
from gscl._errors import ConflictError, InvalidArgumentError, assign, check, set_target
from gscl._images import Picture, load, to_struct
from gscl._inspect import File, read, read_settings
from gscl._names import BLENDS, SAMPLES, Blend, number_of, word_of
from gscl._progress import ProgressCallback, call, interruptible
from gscl._records import Record, Reported

SPLAT_DTYPE = numpy.dtype(
    [
        ("x", "f4"),
        ("y", "f4"),
        ("sigma1", "f4"),
        ("sigma2", "f4"),
        ("theta", "f4"),
        ("opacity", "f4"),
        ("colour", "f4", (4,)),
        ("wave_x", "f4"),
        ("wave_y", "f4"),
        ("wave_phase", "f4"),
        ("wave_amplitude", "f4"),
        ("layer", "u4"),
    ]
)
"""One splat: centre and standard deviations in pixels of the encoded size; the direction of the sigma1 axis in radians,
0..pi from +x towards +y; opacity; red, green, blue, premultiplied, and alpha; the wave in cycles per pixel along x and y, its
phase in cycles and its amplitude, 0 without one; the layer of a progressive file."""

CUTOFF = 7.0
"""Half the squared distance, in standard deviations, beyond which a splat draws nothing."""
BACKGROUND_WEIGHT = 1 / 1024
"""Weight of the background in the blend "normalized"."""
LARGEST_ALPHA = 0.999
"""The largest alpha of a splat at a pixel in the blend "alpha"."""


@dataclass(frozen=True, eq=False, repr=False)
class Field(Record):
    """Splats, with all that is needed to draw them."""

    width: int
    """Of the picture, pixels."""
    height: int
    channels: int
    """Of the picture: 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA."""
    blend: str
    """How colours are combined: "normalized", "alpha" or "sum"."""
    splats: NDArray[numpy.void] = field(repr=False)
    """SPLAT_DTYPE, in the order in which they are drawn."""
    background: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)
    """Red, green, blue, premultiplied, and alpha."""
    has_mean_background: bool = field(default=False, repr=False)
    """Whether the background is the mean of the colours of the splats."""
    dtype: str = field(default="uint8", repr=False)
    """Of the picture's samples: "uint8" or "uint16"."""
    steps: tuple[int, ...] | None = field(default=None, repr=False)
    """Quantiser steps of the file (gscl_steps in gscl/gscl.h); None of a field that is not of a file in the default profile."""


def read_field(file: File, *, bare: bool = False) -> Field:
    """Reads all splats of a file, with what is needed to draw them.  Raises a subclass of FileError, or OSError."""
    content = read(file, bare)
    found = ffi.new("gscl_field *", {"struct_size": ffi.sizeof("gscl_field")})
    check(lib.gscl_read_field(content.buffer, content.size, read_settings(bare), found), subject=content.name)
    memory = ffi.gc(found.splats, lib.gscl_free)
    steps = found.steps
    return Field(
        width=found.width,
        height=found.height,
        channels=found.channels,
        blend=word_of(BLENDS, found.blend),
        splats=numpy.frombuffer(ffi.buffer(memory, found.count * SPLAT_DTYPE.itemsize), dtype=SPLAT_DTYPE),
        background=(found.background[0], found.background[1], found.background[2], found.background[3]),
        has_mean_background=found.has_mean_background,
        dtype=word_of(SAMPLES, found.sample),
        steps=_steps_of(steps) if found.has_steps else None,
    )


_STEPS = ("scale", "position", "angle", "luma", "chroma", "alpha", "opacity", "pivot")


def _steps_of(steps: Any) -> tuple[int, ...]:
    return tuple(getattr(steps, name) for name in _STEPS)


def splats(file: File, *, bare: bool = False) -> NDArray[numpy.void]:
    """Reads all splats in drawing order, as a structured array: SPLAT_DTYPE.  Raises a subclass of FileError, or OSError."""
    return read_field(file, bare=bare).splats


# ---- Arrays of other programs ----------------------------------------------------------------------


def make_splats(
    centre: ArrayLike,
    colour: ArrayLike,
    *,
    sigma: ArrayLike | None = None,
    theta: ArrayLike = 0.0,
    covariance: ArrayLike | None = None,
    cholesky: ArrayLike | None = None,
    opacity: ArrayLike = 1.0,
) -> NDArray[numpy.void]:
    """Makes an array of SPLAT_DTYPE from arrays with a row for each of N splats.

    centre: (N, 2): x and y in pixels; pixel (i, j) has its centre at (i + 0.5, j + 0.5).
    colour: (N,) or (N, 1) grey, (N, 2) grey and alpha, (N, 3) red, green, blue, (N, 4) with alpha; premultiplied.
    sigma: (N, 2): standard deviations along theta and across it, pixels; or (N,) of circles.
    theta: direction of the first of them, radians from +x towards +y, which points down.
    covariance: (N, 2, 2), or (N, 3): xx, xy, yy; pixels squared.
    cholesky: (N, 3): l11, l21, l22 of the covariance's lower factor; pixels.
    opacity: (N,) opacities, or weights in the blend "normalized".

    Raises InvalidArgumentError, which names the row, for what is no covariance.
    """
    places = _rows(centre, "centre", (2,))
    colours = numpy.asarray(colour, numpy.float32)
    colours = colours[:, None] if colours.ndim == 1 else colours
    if colours.ndim != 2 or colours.shape[0] != len(places) or not 1 <= colours.shape[1] <= 4:
        raise InvalidArgumentError(f"colour: shape {colours.shape}: expected ({len(places)}, channels) with 1 to 4 channels")
    made = numpy.zeros(len(places), SPLAT_DTYPE)
    made["x"], made["y"] = places[:, 0], places[:, 1]
    made["opacity"] = _column(opacity, "opacity", len(places))
    made["colour"][:, :3] = colours[:, :3] if colours.shape[1] > 2 else colours[:, :1]
    made["colour"][:, 3] = colours[:, -1] if colours.shape[1] % 2 == 0 else 1
    shapes = [name for name, value in {"sigma": sigma, "covariance": covariance, "cholesky": cholesky}.items() if value is not None]
    if len(shapes) != 1:
        raise ConflictError("give one of sigma, covariance and cholesky")
    if sigma is not None:
        axes = numpy.asarray(sigma, numpy.float64)
        axes = numpy.stack([axes, axes], -1) if axes.ndim == 1 else _rows(axes, "sigma", (2,), len(places))
        made["sigma1"], made["sigma2"] = axes[:, 0], axes[:, 1]
        made["theta"] = _column(theta, "theta", len(places))
    else:
        _set_covariances(made, _covariances(covariance, cholesky, len(places)))
    return made


def _rows(values: ArrayLike, name: str, shape: tuple[int, ...], count: int | None = None) -> NDArray[numpy.float64]:
    rows = numpy.asarray(values, numpy.float64)
    if rows.shape[1:] != shape or rows.ndim == 0 or (count is not None and len(rows) != count):
        expected = ("N" if count is None else str(count), *map(str, shape))
        raise InvalidArgumentError(f"{name}: shape {rows.shape}: expected ({', '.join(expected)})")
    return rows


def _column(values: ArrayLike, name: str, count: int) -> NDArray[numpy.float32]:
    try:
        return numpy.broadcast_to(numpy.asarray(values, numpy.float32).reshape(-1), (count,))
    except ValueError:
        raise InvalidArgumentError(f"{name}: {numpy.size(values)} values: expected {count}, or one for all") from None


def _covariances(covariance: ArrayLike | None, cholesky: ArrayLike | None, count: int) -> NDArray[numpy.float64]:
    """xx, xy and yy of each row."""
    if cholesky is not None:
        a, b, c = _rows(cholesky, "cholesky", (3,), count).T
        return numpy.stack([a * a, a * b, b * b + c * c], -1)
    rows = numpy.asarray(covariance, numpy.float64)
    if rows.ndim == 3:
        rows = _rows(rows, "covariance", (2, 2), count)
        return numpy.stack([rows[:, 0, 0], (rows[:, 0, 1] + rows[:, 1, 0]) / 2, rows[:, 1, 1]], -1)
    return _rows(rows, "covariance", (3,), count)


def _set_covariances(made: NDArray[numpy.void], rows: NDArray[numpy.float64]) -> None:
    """As gscl_splat_set_covariance."""
    xx, xy, yy = rows.T
    with numpy.errstate(all="ignore"):
        larger = (xx + yy) / 2 + numpy.hypot((xx - yy) / 2, xy)
        smaller = (xx / larger) * yy - (xy / larger) * xy
        good = (larger > 0) & (larger < numpy.inf) & (smaller > 0)
    if not good.all():
        row = int(numpy.flatnonzero(~good)[0])
        raise InvalidArgumentError(f"splat {row}: {rows[row].tolist()} (xx, xy, yy) is no covariance of a Gaussian")
    made["sigma1"], made["sigma2"] = numpy.sqrt(larger), numpy.sqrt(smaller)
    made["theta"] = (numpy.arctan2(xy, (xx - yy) / 2) / 2) % numpy.pi


# ---- Packing ---------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False, repr=False)
class PackReport(Record):
    """Results of packing a field."""

    bytes: int
    splats: int
    """Of the file."""
    outside: int
    """Splats of the field that draw nothing, and are left out."""
    divided: int
    """Splats whose colour is too strong for one, and that became several equal ones."""
    changed: int
    """Splats that are replaced by the nearest ones that the format has."""
    changed_psnr: float
    """dB: the field with these against the field without; infinite where none is."""
    field_psnr: float
    """dB: the field's own picture against the reference; infinite where that is the reference."""
    psnr: float
    """dB: the decoded file against the reference."""
    position_error: float
    """The largest error of a code, pixels; NaN where passes chose the codes."""
    axis_error: float
    """Likewise, share of an axis."""
    colour_error: float
    """Likewise, of the range 0..1."""
    seconds: float


class Packed(Reported[PackReport]):
    """What pack returns: the bytes of the file, with a report."""


def pack(
    splats: Field | NDArray[numpy.void],
    *,
    size: tuple[int, int] | None = None,
    blend: Blend | None = None,
    channels: int | None = None,
    background: Sequence[float] | None = None,
    bytes: int | None = None,
    bpp: float | None = None,
    psnr: float | None = None,
    passes: bool = True,
    refine: int = 0,
    reference: Picture | None = None,
    tolerance: float = 0.01,
    bare: bool = False,
    progress: ProgressCallback | None = None,
    device: str | None = None,
    threads: int = 0,
) -> Packed:
    """Writes splats that another program has fitted, or those of a file, as a file: bytes with a report.

    splats: a Field, or an array of SPLAT_DTYPE (make_splats makes one), of which the fields from wave_x on may be missing.
    size: (width, height) of the picture, pixels.
    blend: "normalized", "alpha" or "sum": how the colours of splats are combined.
    channels: 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA; by default RGB, with alpha where some splat's is not 1.
    background: one grey, or red, green, blue, and alpha; 0..1; black by default.
    bytes, bpp, psnr: the target, at most one: bytes or bits per pixel of the whole file, never exceeded; dB against the reference.
        Without one: the finest steps that the format has, or those of a field of a file, whose codes then are the same.
    passes: whether rate-distortion passes choose codes and drop splats: fewer bytes at the same quality.
    refine: 0 to 9: before the passes the splats move towards the reference, as long as an encode of this effort does; 0: not.
    reference: a picture, as encode takes it; by default the field's own picture.
    tolerance: root mean square of the difference that splats may make which the format has not, 0..1; 0.01 is a PSNR of 40 dB.
    bare, progress, device, threads: as of encode.

    Raises InvalidArgumentError, which names the splat by its number from 0 on, for numbers that are none; FieldError for what
    the format does not have; and other subclasses of gscl.Error.
    """
    whole = _field_of(splats, size, blend, channels, background)
    settings = ffi.new("gscl_pack_settings *")
    lib.gscl_pack_settings_init(settings, ffi.sizeof("gscl_pack_settings"))
    targets = {lib.GSCL_TARGET_BYTES: ("bytes", bytes), lib.GSCL_TARGET_BPP: ("bpp", bpp), lib.GSCL_TARGET_PSNR: ("psnr", psnr)}
    set_target(settings, targets)
    settings.passes, settings.bare, settings.tolerance = passes, bare, tolerance
    assign(settings, "refine", refine)
    keep: list[Any] = []
    if reference is not None:
        image, owner = to_struct(load(reference).samples)
        settings.reference = image
        keep += [image, owner]
    struct, owner = _struct_of(whole)

    def work(progress: ProgressCallback | None) -> Packed:
        with context_on(device, threads) as context:
            return _run(context, struct, settings, progress)

    packed = interruptible(work, progress)
    del keep, owner  # which the library read until here
    return packed


def _field_of(
    splats: Field | NDArray[numpy.void],
    size: tuple[int, int] | None,
    blend: str | None,
    channels: int | None,
    background: Sequence[float] | None,
) -> Field:
    """The field of the arguments, which count more than what a field has."""
    if isinstance(splats, Field):
        changes: dict[str, Any] = {"width": size[0], "height": size[1]} if size else {}
        changes |= {"blend": blend} if blend else {}
        changes |= {"channels": channels} if channels else {}
        changes |= {"background": _background(background), "has_mean_background": False} if background is not None else {}
        return replace(splats, **changes)
    rows = _complete(splats)
    if size is None or blend is None:
        raise InvalidArgumentError("size and blend are missing: an array of splats does not say them")
    if channels is None:
        channels = 4 if (rows["colour"][:, 3] != 1).any() else 3
    return Field(size[0], size[1], channels, blend, rows, _background(background if background is not None else (0,)))


def _complete(splats: NDArray[numpy.void]) -> NDArray[numpy.void]:
    """The array as the library reads it."""
    given = numpy.asarray(splats)
    if given.ndim != 1 or given.dtype.names is None:
        raise TypeError("expected a Field, or a structured array of one dimension: SPLAT_DTYPE")
    missing = [name for name in SPLAT_DTYPE.names[:7] if name not in given.dtype.names]  # type: ignore[index]
    if missing:
        raise InvalidArgumentError(f"the array of splats has no field {', '.join(missing)}")
    if given.dtype == SPLAT_DTYPE:
        return numpy.ascontiguousarray(given)
    whole = numpy.zeros(len(given), SPLAT_DTYPE)
    for name in given.dtype.names:
        if name in (SPLAT_DTYPE.names or ()):
            whole[name] = given[name]
    return whole


def _background(values: Sequence[float]) -> tuple[float, float, float, float]:
    numbers = [float(value) for value in values]
    if len(numbers) == 1:
        numbers *= 3
    if len(numbers) not in (3, 4):
        raise InvalidArgumentError(f"background: {len(numbers)} values: expected one grey, red, green, blue, or these and alpha")
    return (numbers[0], numbers[1], numbers[2], numbers[3] if len(numbers) == 4 else 1.0)


def _struct_of(whole: Field) -> tuple[Any, Any]:
    rows = _complete(whole.splats)
    owner = ffi.from_buffer(rows) if len(rows) else ffi.NULL
    struct = ffi.new("gscl_field *", {"struct_size": ffi.sizeof("gscl_field")})
    for name in ("width", "height", "channels"):
        assign(struct, name, getattr(whole, name))
    struct.sample = number_of("dtype", SAMPLES, whole.dtype)
    struct.blend = number_of("blend", BLENDS, whole.blend)
    struct.background = list(whole.background)
    struct.has_mean_background = whole.has_mean_background
    struct.has_steps = whole.steps is not None
    for name, value in zip(_STEPS, whole.steps or ()):
        setattr(struct.steps, name, value)
    struct.count = len(rows)
    struct.splats = ffi.cast("gscl_splat *", owner)
    return struct, (rows, owner)


def _run(context: Any, struct: Any, settings: Any, progress: ProgressCallback | None) -> Packed:
    report = ffi.new("gscl_pack_report *", {"struct_size": ffi.sizeof("gscl_pack_report")})
    data, size = ffi.new("uint8_t **"), ffi.new("size_t *")
    names = [name for name in PackReport.__dataclass_fields__]
    try:
        check(call(settings, progress, lambda: lib.gscl_pack(context, struct, settings, data, size, report)), context)
        found = PackReport(**{name: getattr(report, name) for name in names})
        return Packed(builtins.bytes(ffi.buffer(data[0], size[0])), found)
    finally:
        lib.gscl_free(data[0])
