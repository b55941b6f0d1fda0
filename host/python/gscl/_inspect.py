"""What a file holds, without drawing it."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, BinaryIO, NamedTuple, Union

import numpy
from numpy.typing import NDArray

from gscl._binding import ffi, lib
from gscl._errors import check
from gscl._names import BLENDS, BLOCKS, PROFILES, SAMPLES, effects_of, word_of

File = Union[bytes, bytearray, memoryview, str, "os.PathLike[str]", BinaryIO]
"""The bytes of a gscl file, its path, or an open file."""

SPLAT_DTYPE = numpy.dtype(
    [
        ("x", "f4"),
        ("y", "f4"),
        ("sigma1", "f4"),
        ("sigma2", "f4"),
        ("theta", "f4"),
        ("opacity", "f4"),
        ("colour", "f4", (4,)),
    ]
)
"""One splat: centre and standard deviations in pixels of the encoded size; the direction of the sigma1 axis in radians,
0..pi from +x towards +y; opacity; red, green, blue, premultiplied, and alpha."""


class Content(NamedTuple):
    """The bytes of a file as the library takes them, and the name of the file for messages."""

    buffer: Any
    name: str

    @property
    def size(self) -> int:
        return len(self.buffer)


def read(file: File) -> Content:
    """Reads a file."""
    if isinstance(file, (str, os.PathLike)):
        with open(file, "rb") as opened:
            return Content(ffi.from_buffer("uint8_t[]", opened.read()), os.fspath(file))
    if isinstance(file, (bytes, bytearray, memoryview)):
        return Content(ffi.from_buffer("uint8_t[]", file), "")
    if hasattr(file, "read"):
        return Content(ffi.from_buffer("uint8_t[]", file.read()), str(getattr(file, "name", "")))
    raise TypeError(f"expected bytes, a path or an open file, not {type(file).__name__}")


@dataclass(frozen=True)
class Info:
    """What a file says about itself."""

    format_version: int
    width: int
    height: int
    channels: int
    """Of the decoded picture: 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA."""
    dtype: str
    """Of the source: "uint8" or "uint16"."""
    profile: str
    blend: str
    splats: int
    layers: int
    """Of a progressive file; else 1."""
    effects: tuple[str, ...]
    shape_words: int
    colour_words: int
    bytes: int
    streams: dict[str, float]
    """Bits of each stream in use; empty for header_only."""
    pixels: int
    """What max_pixels limits in a decode at the encoded size."""
    work: int
    """What max_work limits in such a decode; an upper bound for header_only."""


def read_settings(bare: bool) -> Any:
    settings = ffi.new("gscl_read_settings *")
    lib.gscl_read_settings_init(settings, ffi.sizeof("gscl_read_settings"))
    settings.bare = bare
    return settings


def inspect(function: Any, content: Content, bare: bool) -> Any:
    """The gscl_info that gscl_probe or gscl_inspect returns."""
    info = ffi.new("gscl_info *", {"struct_size": ffi.sizeof("gscl_info")})
    check(function(content.buffer, content.size, read_settings(bare), info), subject=content.name)
    return info


def info(file: File, *, bare: bool = False, header_only: bool = False) -> Info:
    """Reads and checks a file, and counts the bits of its streams.

    bare: whether the file was encoded with `bare`, which its bytes do not tell.
    header_only: reads the header alone, which succeeds where only the check does not match.

    Raises a subclass of FileError, or OSError.
    """
    found = inspect(lib.gscl_probe if header_only else lib.gscl_inspect, read(file), bare)
    rows = [found.streams[i] for i in range(found.stream_count)]
    return Info(
        format_version=found.format_version,
        width=found.width,
        height=found.height,
        channels=found.channels,
        dtype=word_of(SAMPLES, found.sample),
        profile=word_of(PROFILES, found.profile),
        blend=word_of(BLENDS, found.blend),
        splats=found.splats,
        layers=found.layers,
        effects=effects_of(found.effects),
        shape_words=found.shape_words,
        colour_words=found.colour_words,
        bytes=found.bytes,
        streams={ffi.string(row.name).decode(): row.bits for row in rows},
        pixels=found.pixels,
        work=found.work,
    )


def metadata(file: File) -> dict[str, Any]:
    """The metadata of a file that is not bare: those of "icc_profile", "exif" (without "Exif\\0\\0"), "xmp" and "cicp" that
    it has.  Raises a subclass of FileError, or OSError."""
    content = read(file)
    found: dict[str, Any] = {}
    for name, kind in {"cicp": lib.GSCL_BLOCK_COLOUR_SPACE, **BLOCKS}.items():
        data, size = ffi.new("void **"), ffi.new("size_t *")
        check(lib.gscl_find_block(content.buffer, content.size, kind, data, size), subject=content.name)
        if data[0]:
            found[name] = bytes(ffi.buffer(data[0], size[0]))
    if "cicp" in found:
        found["cicp"] = tuple(found["cicp"])
    return found


def splats(file: File, *, bare: bool = False) -> NDArray[numpy.void]:
    """Reads all splats in drawing order, as a structured array: SPLAT_DTYPE.  Raises a subclass of FileError, or OSError."""
    content = read(file)
    rows, count = ffi.new("gscl_splat **"), ffi.new("size_t *")
    result = lib.gscl_read_splats(content.buffer, content.size, read_settings(bare), rows, count)
    check(result, subject=content.name)
    memory = ffi.gc(rows[0], lib.gscl_free)
    return numpy.frombuffer(ffi.buffer(memory, count[0] * SPLAT_DTYPE.itemsize), dtype=SPLAT_DTYPE)


def certain_splats(file: File, *, bare: bool = False) -> tuple[int, int]:
    """Counts the splats that the first bytes of a file hold, and those of the whole file.  decode with `partial` draws
    them.  Raises a subclass of FileError, or OSError."""
    content = read(file)
    certain, total = ffi.new("uint32_t *"), ffi.new("uint32_t *")
    result = lib.gscl_certain_splats(content.buffer, content.size, read_settings(bare), certain, total)
    check(result, subject=content.name)
    return certain[0], total[0]
