"""What a run makes of each of its files."""

from __future__ import annotations

import abc
import functools
import io
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import IO, Any, ClassVar, Literal, NamedTuple

import numpy
from PIL import Image, UnidentifiedImageError

from gscl import fields
from gscl._devices import HOST
from gscl._encode import Encoded, encode
from gscl._errors import (
    BudgetTooSmallError,
    CancelledError,
    ConflictError,
    InvalidArgumentError,
    NoEncoderError,
    TargetUnreachableError,
)
from gscl._fields import SPLAT_DTYPE, Field, pack, read_field
from gscl._inspect import info

Encoder = Callable[..., Encoded]
"""Called with the bytes of a picture's file, and by name with `device` and the settings of the run."""

Loader = Callable[[IO[bytes]], Field]
"""Called with the file of a field, open, whose `name` is its URL or path."""
LoaderName = Literal["npz", "csv", "ply", "gaussianimage", "gaussianimage_plus", "image_gs"]
"""A function of gscl.fields, without load_."""

_TABLES: dict[str, Callable[..., Field]] = {"npz": fields.load_npz, "csv": fields.load_csv, "ply": fields.load_ply}
_CHECKPOINTS: dict[str, Callable[..., Field]] = {
    "gaussianimage": fields.load_gaussianimage,
    "gaussianimage_plus": fields.load_gaussianimage_plus,
    "image_gs": fields.load_image_gs,
}
_LOADERS = {**_TABLES, **_CHECKPOINTS}


class Figures(NamedTuple):
    """What the row of a file says about its output, besides bytes."""

    width: int
    height: int
    splats: int
    psnr: float | None = None
    ssimulacra2: float | None = None


class Conversion(abc.ABC):
    """What a run makes of each of its files.  Each worker has a copy."""

    name: ClassVar[str]
    """In the settings of a report."""
    suffix: ClassVar[str]
    """Of the names of outputs."""
    has_device: ClassVar[bool]
    """Whether it computes on a device."""

    @abc.abstractmethod
    def settings(self) -> dict[str, Any]:
        """What outputs depend on: a report is of one conversion with the same settings."""

    @abc.abstractmethod
    def check(self, threads: int) -> None:
        """Raises what every file would raise.  threads: of the device "host"; 0 for the default."""

    @abc.abstractmethod
    def convert(self, data: bytes, source: str, *, device: str | None, threads: int) -> tuple[bytes, Figures]:
        """The output for the bytes of a file, whose name is `source`."""

    @abc.abstractmethod
    def examine(self, output: bytes) -> Figures:
        """Figures of an output that is there.  Raises ValueError where it is not whole."""


def _check_arguments(function: Callable[..., object], first: object, threads: int, arguments: dict[str, Any]) -> None:
    """Raises what a call with these arguments raises before its work.  The library checks settings first, and ends there: by
    the callback, or because "host" has no kernels, or because of a target that only a picture of this size misses."""
    try:
        function(first, device=HOST, threads=threads, progress=lambda state: False, **arguments)
    except (CancelledError, NoEncoderError, BudgetTooSmallError, TargetUnreachableError):
        pass


@dataclass(frozen=True)
class Encoding(Conversion):
    """Encodes pictures."""

    arguments: dict[str, Any]
    """Of the encoder, by their names."""
    encoder: Encoder | None = None
    """None for encode_file."""

    name = "encode"
    suffix = ".gscl"
    has_device = True

    def settings(self) -> dict[str, Any]:
        return self.arguments

    def check(self, threads: int) -> None:
        if self.encoder is None:
            _check_arguments(encode, numpy.zeros((8, 8), numpy.uint8), threads, self.arguments)

    def convert(self, data: bytes, source: str, *, device: str | None, threads: int) -> tuple[bytes, Figures]:
        encoder = self.encoder or functools.partial(encode_file, threads=threads)
        encoded = encoder(data, device=device, **self.arguments)
        found, report = info(encoded, bare=_is_bare(self.arguments), header_only=True), encoded.report
        ssimulacra2 = None if math.isnan(report.ssimulacra2) else report.ssimulacra2
        return encoded, Figures(found.width, found.height, report.splats, report.psnr, ssimulacra2)

    def examine(self, output: bytes) -> Figures:
        return _examine_file(output, _is_bare(self.arguments))


def encode_file(picture: bytes, *, device: str | None, threads: int = 1, **settings: Any) -> Encoded:
    """The encoder of a run that has no other one.  It takes one thread, as workers have an encoder for each core."""
    try:
        image = Image.open(io.BytesIO(picture))
    except UnidentifiedImageError:
        raise UnidentifiedImageError("not an image that Pillow reads") from None
    with image:
        encoded: Encoded = encode(image, device=device, threads=threads, **settings)
        return encoded


@dataclass(frozen=True)
class Packing(Conversion):
    """Packs fields."""

    arguments: dict[str, Any]
    """Of gscl.pack, by their names."""
    loader: Loader | LoaderName | None
    description: dict[str, Any]
    """Arguments of a loader that has a name: those of size, blend and background that the caller gave."""

    name = "pack"
    suffix = ".gscl"
    has_device = True

    def settings(self) -> dict[str, Any]:
        loader = None if callable(self.loader) else self.loader  # a function has no text that stays the same
        return {"loader": loader, **self.description, **self.arguments}

    def check(self, threads: int) -> None:
        if "reference" in self.arguments:
            raise InvalidArgumentError("reference: in a batch each field is its own reference")
        self._check_loader()
        anything = {"size": (8, 8), "blend": "normalized", **self.description, **self.arguments}
        _check_arguments(pack, numpy.zeros(0, SPLAT_DTYPE), threads, anything)

    def _check_loader(self) -> None:
        if callable(self.loader):
            if self.description:
                raise ConflictError(f"{', '.join(self.description)}: a function as loader returns fields that have them")
        elif self.loader in _CHECKPOINTS:
            if list(self.description) != ["size"]:
                raise ConflictError(f"{self.loader}: takes size, which checkpoints do not say, no blend and no background")
            fields._torch("packing checkpoints")
        elif self.loader is not None and self.loader not in _TABLES:
            raise InvalidArgumentError(f"loader: {self.loader!r}: expected one of {', '.join(_LOADERS)}")

    def convert(self, data: bytes, source: str, *, device: str | None, threads: int) -> tuple[bytes, Figures]:
        packed = pack(self._load(data, source), device=device, threads=threads, **self.arguments)
        found = info(packed, bare=_is_bare(self.arguments), header_only=True)
        return packed, Figures(found.width, found.height, packed.report.splats, packed.report.psnr)

    def _load(self, data: bytes, source: str) -> Field:
        file = io.BytesIO(data)
        file.name = source
        if callable(self.loader):
            return self.loader(file)
        name = self.loader or source.partition("::")[0].rpartition(".")[2].lower()
        if not self.loader and name not in _TABLES:
            raise InvalidArgumentError(f"the name ends with none of .{', .'.join(_TABLES)}: give a loader")
        return _LOADERS[name](file, **self.description)

    def examine(self, output: bytes) -> Figures:
        return _examine_file(output, _is_bare(self.arguments))


@dataclass(frozen=True)
class Unpacking(Conversion):
    """Reads the fields of files."""

    bare: bool

    name = "unpack"
    suffix = ".npz"
    has_device = False

    def settings(self) -> dict[str, Any]:
        return {"bare": self.bare}

    def check(self, threads: int) -> None:
        """There is nothing that every file would raise."""

    def convert(self, data: bytes, source: str, *, device: str | None, threads: int) -> tuple[bytes, Figures]:
        field, memory = read_field(data, bare=self.bare), io.BytesIO()
        fields.save_npz(field, memory)
        return memory.getvalue(), _figures_of(field)

    def examine(self, output: bytes) -> Figures:
        return _figures_of(fields.load_npz(io.BytesIO(output)))


def _figures_of(field: Field) -> Figures:
    return Figures(field.width, field.height, len(field.splats))


def _is_bare(arguments: dict[str, Any]) -> bool:
    return bool(arguments.get("bare"))


def _examine_file(output: bytes, is_bare: bool) -> Figures:
    found = info(output, bare=is_bare)
    return Figures(found.width, found.height, found.splats)
