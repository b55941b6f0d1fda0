"""Fields of other programs and of tables: what reads them returns a gscl.Field, which gscl.pack writes as a file.

    field = gscl.fields.load_gaussianimage("gaussian_model.pth.tar", size=(768, 512))
    data = gscl.pack(field, psnr=32, reference="photo.png")

A file is a path, or open in binary mode, from where it stands.  Checkpoints are files of PyTorch, for which there is
`pip install 'gscl[torch]'`, or dictionaries of their arrays, which need nothing.
"""

from __future__ import annotations

import csv
import importlib
import io
import math
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import IO, Any, Union

import numpy
from numpy.typing import ArrayLike, NDArray

from gscl._errors import InvalidArgumentError
from gscl._fields import SPLAT_DTYPE, Field, _background, _complete, make_splats
from gscl._files import StoredFile, read_stored
from gscl._names import BLENDS, Blend, number_of

__all__ = [
    "load_csv",
    "load_gaussianimage",
    "load_gaussianimage_plus",
    "load_image_gs",
    "load_npz",
    "load_ply",
    "save_npz",
    "tensors",
]

Checkpoint = Union[StoredFile, Mapping[str, Any]]
"""A file that torch.save wrote, or what it holds: arrays or tensors by their names."""

_HALF_PIXEL = 0.5
"""All of these programs have the centre of the first pixel at 0, and gscl at 0.5."""
_SUM_GAIN = (1 - 1 / 255) / (1 - 8 * math.exp(-7))
"""They cut a splat off below 1/255, gscl subtracts its value at the cut-off: with this factor both have the same integral."""


# ---- Checkpoints -----------------------------------------------------------------------------------


def load_gaussianimage(checkpoint: Checkpoint, *, size: tuple[int, int]) -> Field:
    """Reads a field of GaussianImage: the file gaussian_model.pth.tar of its train.py, of both of its models.

    size: (width, height) of the picture, pixels; the file does not say them.

    Raises InvalidArgumentError for other contents, and ImportError without PyTorch.
    """
    values = _Values(checkpoint, "GaussianImage")
    values.refuse("_quantizer.", "is of train_quantize.py, whose codes are not read: take the file of train.py")
    places, opacity = numpy.tanh(values["_xyz", 2]), values.get("_opacity", 1)
    shape: dict[str, ArrayLike]
    if "_cholesky" in values:
        shape = {"cholesky": values["_cholesky", 3] + (0.5, 0, 0.5)}
    else:  # the angle is from +x towards -y
        turns = 1 / (1 + numpy.exp(-values["_rotation", 1][:, 0]))
        shape = {"sigma": numpy.abs(values["_scaling", 2] + 0.5), "theta": -2 * math.pi * turns}
    return _sum_field(size, (places + 1) / 2 * size + _HALF_PIXEL, values["_features_dc", 3], opacity, shape)


def load_gaussianimage_plus(checkpoint: Checkpoint, *, size: tuple[int, int], color_norm: bool = False) -> Field:
    """Reads a field of GaussianImage++: the file gaussian_model.pth.tar of its train.py.

    size: (width, height) of the picture, pixels; the file does not say them.
    color_norm: whether it was trained with --color_norm, which the file does not say either.

    Raises InvalidArgumentError for other contents, and ImportError without PyTorch.
    """
    outer = _Values(checkpoint, "GaussianImage++")
    values = outer.inner("gs")
    values.refuse("_quantizer.", "is of train_quantize.py, whose codes are not read: take the file of train.py")
    added = outer["slv_bound", 3] if "slv_bound" in outer else values["cholesky_bound", 3]
    covariance, colour = values["_cov2d", 3] + added, values["_features_dc", 3]
    if color_norm:
        colour = 1 / (1 + numpy.exp(-colour))
    drawn = (covariance[:, 0] > 0) & (covariance[:, 0] * covariance[:, 2] > covariance[:, 1] ** 2)  # others it leaves out
    places, opacity = values["_xyz", 2] + _HALF_PIXEL, values.get("_opacity", 1)
    return _sum_field(size, places[drawn], colour[drawn], opacity[drawn], {"covariance": covariance[drawn]})


def load_image_gs(checkpoint: Checkpoint, *, size: tuple[int, int], inverse_scale: bool = True, topk_norm: bool = True) -> Field:
    """Reads a field of Image-GS: a file ckpt_step-N.pt, of an image of one or three channels and gamma 1.

    size: (width, height) of the picture, pixels; the file does not say them.
    inverse_scale, topk_norm: False where it was trained with disable_inverse_scale or disable_topk_norm.

    gscl has no blend of the ten strongest splats of a pixel: with topk_norm, all of them are blended.  That is the same where
    few overlap; else pack with the picture as reference and refine.

    Raises InvalidArgumentError for other contents, and ImportError without PyTorch.
    """
    values = _Values(checkpoint, "Image-GS").inner("state_dict")
    scale, colour = values["scale", 2], values["feat", None]
    if colour.shape[1] not in (1, 3):
        raise InvalidArgumentError(
            f"feat has {colour.shape[1]} columns, a stack of pictures: pass a dictionary with the 1 or 3 columns of one"
        )
    places = values["xy", 2] * size + _HALF_PIXEL
    shape: dict[str, ArrayLike] = {
        "sigma": numpy.abs(1 / scale if inverse_scale else scale),
        "theta": -values["rot", 1][:, 0],  # from +x towards -y
    }
    if not topk_norm:
        return _sum_field(size, places, colour, numpy.ones((len(places), 1)), shape)
    mean = colour.mean(0) if len(colour) else numpy.zeros(colour.shape[1])
    splats = make_splats(places, colour, **shape)
    return Field(*size, colour.shape[1], "normalized", splats, _background(mean.tolist()), has_mean_background=True)


def _sum_field(
    size: tuple[int, int], places: NDArray[Any], colour: NDArray[Any], opacity: NDArray[Any], shape: Mapping[str, ArrayLike]
) -> Field:
    """Their sum has nothing behind it, whatever background they pass along."""
    weights = opacity[:, 0] * _SUM_GAIN
    splats = make_splats(places, colour, opacity=weights, **shape)
    return Field(*size, colour.shape[1], "sum", splats)


class _Values:
    """Arrays of a checkpoint by their names."""

    def __init__(self, checkpoint: Checkpoint, program: str):
        self._program = program
        self._values = checkpoint if isinstance(checkpoint, Mapping) else _load_checkpoint(checkpoint)

    def __contains__(self, name: str) -> bool:
        return name in self._values

    def inner(self, name: str) -> _Values:
        """The dictionary of this name, or this one where there is none."""
        return _Values(self._values[name], self._program) if isinstance(self._values.get(name), Mapping) else self

    def refuse(self, part: str, why: str) -> None:
        if any(part in name for name in self._values):
            raise InvalidArgumentError(f"the checkpoint {why}")

    def __getitem__(self, wanted: tuple[str, int | None]) -> NDArray[numpy.float64]:
        """Rows of so many columns."""
        name, columns = wanted
        if name not in self._values:
            raise InvalidArgumentError(f"the checkpoint has no {name}: it is not of {self._program}")
        value = self._values[name]
        rows = numpy.asarray(value.detach().cpu().double() if hasattr(value, "detach") else value, numpy.float64)
        if rows.ndim != 2 or (columns is not None and rows.shape[1] != columns):
            raise InvalidArgumentError(f"{name} of the checkpoint: shape {rows.shape}: expected (N, {columns or 'channels'})")
        return rows

    def get(self, name: str, columns: int) -> NDArray[numpy.float64]:
        """As above, or ones for each splat."""
        return self[name, columns] if name in self else numpy.ones((len(self["_xyz", 2]), columns))


def _load_checkpoint(file: StoredFile) -> Mapping[str, Any]:
    torch = _torch("reading checkpoints")
    content, source = read_stored(file)
    try:
        found = torch.load(io.BytesIO(content), map_location="cpu", weights_only=True)
    except Exception as error:  # of pickle, of zip files, or of what is in them
        raise _wrong(source, "is no checkpoint of tensors and numbers alone") from error
    if not isinstance(found, Mapping):
        raise _wrong(source, f"holds a {type(found).__name__}: expected a dictionary of tensors")
    return found


def _wrong(source: str, what: str) -> InvalidArgumentError:
    """source: the name of the file; "" where it has none."""
    return InvalidArgumentError(f"{source}: {what}" if source else what)


def _torch(purpose: str) -> Any:
    try:
        return importlib.import_module("torch")
    except ImportError as error:
        raise ImportError(f"{purpose} needs PyTorch: pip install 'gscl[torch]'") from error


# ---- Tensors ---------------------------------------------------------------------------------------


def tensors(field: Field, *, device: Any = None) -> dict[str, Any]:
    """The splats as tensors of PyTorch by the names of SPLAT_DTYPE: colour (N, 4), the others (N,), layer int64.

    device: as torch.Tensor.to takes it.

    They are copies; requires_grad_() makes parameters of them.  Raises ImportError without PyTorch.
    """
    torch = _torch("gscl.fields.tensors")
    rows = _complete(field.splats)
    made = {name: torch.from_numpy(rows[name].astype("i8" if name == "layer" else "f4")) for name in rows.dtype.names or ()}
    return {name: value.to(device) for name, value in made.items()}


# ---- Tables ----------------------------------------------------------------------------------------

_SHAPES = (("sigma1", "sigma2"), ("cov_xx", "cov_xy", "cov_yy"), ("l11", "l21", "l22"))
_OTHERS = ("wave_x", "wave_y", "wave_phase", "wave_amplitude", "layer")


def save_npz(field: Field, file: str | os.PathLike[str] | IO[bytes]) -> None:
    """Writes a field as NPZ: a key for each column of `gscl export`, and for what else it takes to draw them.

    load_npz reads it without any loss: what pack makes of both is the same.  Raises OSError.
    """
    if isinstance(file, (str, os.PathLike)):
        with open(file, "wb") as opened:
            save_npz(field, opened)
        return
    rows = _complete(field.splats)
    values: dict[str, Any] = {name: rows[name] for name in rows.dtype.names or () if name != "colour"}
    values |= {name: rows["colour"][:, i] for i, name in enumerate(("red", "green", "blue", "alpha"))}
    values |= {name: getattr(field, name) for name in ("width", "height", "channels", "blend", "background")}
    values |= {"mean": field.has_mean_background, "bits": 16 if field.dtype == "uint16" else 8}
    values |= {} if field.steps is None else {"steps": field.steps}
    numpy.savez_compressed(file, **values)


def load_npz(
    file: StoredFile,
    *,
    size: tuple[int, int] | None = None,
    blend: Blend | None = None,
    background: Sequence[float] | None = None,
) -> Field:
    """Reads a field as save_npz writes it, or with fewer keys: those of the columns that load_csv needs.

    size, blend, background: as of pack; what the file does not say.

    Raises InvalidArgumentError for other contents, and OSError.
    """
    content, source = read_stored(file)
    values = _arrays(content, source)
    scalars = {name: values.pop(name) for name in _DESCRIPTION if name in values}
    said = {name: value.tolist() for name, value in scalars.items()}
    return _field(source, values, said, size, blend, background)


def _arrays(content: bytes, source: str) -> dict[str, NDArray[Any]]:
    try:
        with numpy.load(io.BytesIO(content), allow_pickle=False) as arrays:
            return {name: arrays[name] for name in arrays.files}
    except Exception as error:  # of zip files, of what is in them, or of what is no zip file
        raise _wrong(source, "is no NPZ file of arrays of numbers") from error


def load_csv(
    file: StoredFile,
    *,
    size: tuple[int, int] | None = None,
    blend: Blend | None = None,
    background: Sequence[float] | None = None,
) -> Field:
    """Reads a table with a line of names: x, y; sigma1, sigma2 and theta, or cov_xx, cov_xy, cov_yy, or l11, l21, l22; red, green
    and blue, or grey; and, where there are any, alpha, opacity or weight, and the other columns of `gscl export`.

    size, blend, background: as of pack; a table says them in a line "# gscl width=768 height=512 blend=sum", or not at all.

    Raises InvalidArgumentError for other contents, and OSError.
    """
    said: dict[str, Any] = {}
    content, source = read_stored(file)
    try:
        text = content.decode()
    except UnicodeDecodeError as error:
        raise _wrong(source, "is no text in UTF-8") from error
    lines = [line for line in io.StringIO(text, newline="") if not _is_comment(line, said, source) and line.strip()]
    rows = list(csv.reader(lines, skipinitialspace=True))
    if not rows:
        raise _wrong(source, "has no line with the names of its columns")
    return _field(source, _columns(source, rows[0], rows[1:]), said, size, blend, background)


def load_ply(
    file: StoredFile,
    *,
    size: tuple[int, int] | None = None,
    blend: Blend | None = None,
    background: Sequence[float] | None = None,
) -> Field:
    """Reads the vertices of a PLY file, text or binary, with the properties that load_csv takes as columns.

    size, blend, background: as of pack; what the file does not say in a comment, as `gscl export` writes it.

    Raises InvalidArgumentError for other contents, and OSError.
    """
    content, source = read_stored(file)
    end = content.find(b"end_header")
    if not content.startswith(b"ply") or end < 0:
        raise _wrong(source, "is no PLY file: no ply at its start, or no end_header")
    said: dict[str, Any] = {}
    count, properties, form = _read_header(source, content[:end].decode("ascii", "replace"), said)
    body = content[content.index(b"\n", end) + 1 :]
    if form == "ascii":
        rows = [line.split() for line in body.decode("ascii", "replace").splitlines()[:count]]
        columns = _columns(source, [name for name, _ in properties], rows)
    else:
        order = "<" if form == "binary_little_endian" else ">"
        kind = numpy.dtype([(name, order + code) for name, code in properties])
        if len(body) < count * kind.itemsize:
            raise _wrong(source, f"is incomplete: {count} splats take {kind.itemsize} bytes each")
        table = numpy.frombuffer(body, kind, count)
        columns = {name: table[name] for name, _ in properties}
    if len(next(iter(columns.values()), ())) != count:
        raise _wrong(source, f"is incomplete: it has fewer than {count} splats")
    return _field(source, columns, said, size, blend, background)


_PLY_TYPES = {
    name: code
    for code, names in {
        "i1": "char int8", "u1": "uchar uint8", "i2": "short int16", "u2": "ushort uint16",
        "i4": "int int32", "u4": "uint uint32", "f4": "float float32", "f8": "double float64",
    }.items()
    for name in names.split()
}  # fmt: skip


def _read_header(source: str, text: str, said: dict[str, Any]) -> tuple[int, list[tuple[str, str]], str]:
    """The number of vertices, which come first, the names and types of their properties, and the form of the numbers."""
    count, properties, form, elements = 0, list[tuple[str, str]](), "", list[str]()
    for line in text.splitlines():
        words = line.split()
        if words[:1] == ["comment"]:
            _read_description(words[1:], said, source)
        elif words[:1] == ["format"] and len(words) > 1:
            form = words[1]
        elif words[:1] == ["element"] and len(words) == 3 and words[2].isdecimal():
            elements.append(words[1])
            count = int(words[2]) if len(elements) == 1 else count
        elif words[:1] == ["property"] and len(elements) == 1:
            if len(words) != 3 or words[1] not in _PLY_TYPES:
                raise _wrong(source, f"'{line.strip()}' is no property of a splat")
            properties.append((words[2], _PLY_TYPES[words[1]]))
    if elements[:1] != ["vertex"] or form not in ("ascii", "binary_little_endian", "binary_big_endian"):
        raise _wrong(source, "its first element is not vertex, or its format is not known")
    return count, properties, form


def _columns(source: str, names: Sequence[str], rows: Sequence[Sequence[str]]) -> dict[str, NDArray[Any]]:
    for number, row in enumerate(rows):
        if len(row) != len(names):
            raise _wrong(source, f"splat {number}: {len(row)} values; there are {len(names)} columns")
    known = {"x", "y", "theta", "red", "green", "blue", "grey", "alpha", "opacity", "weight", *_OTHERS}.union(*_SHAPES)
    chosen = [(i, name.strip().lower()) for i, name in enumerate(names) if name.strip().lower() in known]
    try:
        return {name: numpy.array([float(row[i]) for row in rows]) for i, name in chosen}
    except ValueError as error:
        raise _wrong(source, str(error)) from None


# ---- What a table says besides ---------------------------------------------------------------------

_DESCRIPTION = ("width", "height", "channels", "bits", "blend", "background", "mean", "steps")


def _is_comment(line: str, said: dict[str, Any], source: str) -> bool:
    if line.startswith("#"):
        _read_description(line.lstrip("# ").split(), said, source)
    return line.startswith("#")


def _read_description(words: Sequence[str], said: dict[str, Any], source: str) -> None:
    """The words of a comment that begins with gscl."""
    if words[:1] != ["gscl"]:
        return
    for word in words[1:]:
        name, _, value = word.partition("=")
        try:
            if name in ("width", "height", "channels", "bits"):
                said[name] = int(value)
            elif name == "blend":
                said[name] = value
            elif name == "background":
                said[name] = [float(part) for part in value.split(",")]
            elif name == "steps":
                said[name] = [int(part) for part in value.split(",")]
            elif word == "mean":
                said[name] = True
        except ValueError:
            raise _wrong(source, f"{word} is not what gscl export writes there") from None


def _field(
    source: str,
    columns: Mapping[str, NDArray[Any]],
    said: Mapping[str, Any],
    size: tuple[int, int] | None,
    blend: Blend | None,
    background: Sequence[float] | None,
) -> Field:
    """The field of columns, and of what the file or else the caller says about them."""
    splats = _splats(source, columns)
    size = size or ((said["width"], said["height"]) if "width" in said and "height" in said else None)
    name = blend or said.get("blend")
    if size is None or name in (None, "auto"):
        raise _wrong(source, "does not say the size of the picture, or its blend: pass size and blend")
    number_of("blend", BLENDS, name)
    channels = said.get("channels") or (1 if "grey" in columns else 3) + ("alpha" in columns and _has_alpha(splats))
    given = Field(size[0], size[1], channels, name, splats, _background(said.get("background", (0,))))
    steps = tuple(int(step) for step in said["steps"]) if "steps" in said else None
    dtype = "uint16" if said.get("bits", 8) > 8 else "uint8"
    given = replace(given, has_mean_background=bool(said.get("mean", False)), steps=steps, dtype=dtype)
    return given if background is None else replace(given, background=_background(background), has_mean_background=False)


def _has_alpha(splats: NDArray[numpy.void]) -> bool:
    return bool((splats["colour"][:, 3] != 1).any())


def _splats(source: str, columns: Mapping[str, NDArray[Any]]) -> NDArray[numpy.void]:
    forms = [form for form in _SHAPES if all(name in columns for name in form)]
    missing = [name for name in ("x", "y") if name not in columns]
    missing += [] if forms else ["sigma1 and sigma2 (or cov_xx, cov_xy, cov_yy, or l11, l21, l22)"]
    missing += [] if "grey" in columns else [name for name in ("red", "green", "blue") if name not in columns]
    if missing:
        raise _wrong(source, f"has no column {', '.join(missing)}")
    colours = ["grey"] if "red" not in columns else ["red", "green", "blue"]
    centre, colour = _stacked(columns, ("x", "y")), _stacked(columns, [*colours, *(["alpha"] if "alpha" in columns else [])])
    opacity = columns.get("opacity", columns.get("weight", 1.0))
    shape: dict[str, Any] = {("sigma", "covariance", "cholesky")[_SHAPES.index(forms[0])]: _stacked(columns, forms[0])}
    if "sigma" in shape:
        shape["theta"] = columns.get("theta", 0.0)
    splats = make_splats(centre, colour, opacity=opacity, **shape)
    for name in _OTHERS:
        if name in columns:
            splats[name] = columns[name]
    return splats


def _stacked(columns: Mapping[str, NDArray[Any]], names: Iterable[str]) -> NDArray[Any]:
    return numpy.stack([columns[name] for name in names], -1)
