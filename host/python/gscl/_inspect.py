"""What a file holds, without drawing it."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Union

from gscl._binding import ffi, lib
from gscl._errors import DamagedError, TruncatedError, check
from gscl._files import StoredFile, is_file, read_stored
from gscl._names import BLENDS, BLOCKS, PROFILES, SAMPLES, effects_of, word_of
from gscl._packets import Buffer, is_packet, join
from gscl._records import Record

File = Union[Buffer, StoredFile, Sequence[Buffer]]
"""The bytes of a gscl file, its path, or an open binary file, from where it stands.  The file may be a list of packets, or one
packet; and packets may come as a list or tuple of their bytes.  Those that are damaged, repeated or of another picture than the
first one are left out."""

class Content(NamedTuple):
    """The bytes of a file as the library takes them, and the name of the file for messages."""

    buffer: Any
    name: str

    @property
    def size(self) -> int:
        return len(self.buffer)


def read(file: File, bare: bool = False) -> Content:
    """Reads a file.  Packets become a list of them."""
    data, name = _read_bytes(file)
    if not bare and is_packet(data):
        data = join([data])
    return Content(ffi.from_buffer("uint8_t[]", data), name)


def _read_bytes(file: File) -> tuple[Buffer, str]:
    if isinstance(file, (bytes, bytearray, memoryview)):
        return file, ""
    if isinstance(file, (list, tuple)):
        return _joined(file), ""
    if isinstance(file, (str, os.PathLike)) or is_file(file):
        return read_stored(file)
    raise TypeError(f"expected bytes, a path or an open file, or packets, not {type(file).__name__}")


def _joined(packets: Sequence[Buffer]) -> bytes:
    joined = join(packets)
    if not joined:
        check(lib.GSCL_ERROR_DAMAGED if packets else lib.GSCL_ERROR_TRUNCATED)
    return joined


@dataclass(frozen=True, eq=False, repr=False)
class Info(Record):
    """What a file says about itself."""

    format_version: int = field(repr=False)
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
    packets: int
    """Of a list of packets, how many were read; 0 for a file and for header_only."""
    effects: tuple[str, ...]
    shape_words: int = field(repr=False)
    colour_words: int = field(repr=False)
    bytes: int
    streams: dict[str, float] = field(repr=False, hash=False)
    """Bits of each stream in use; empty for header_only."""
    pixels: int = field(repr=False)
    """What max_pixels limits in a decode at the encoded size."""
    work: int = field(repr=False)
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
    found = inspect(lib.gscl_probe if header_only else lib.gscl_inspect, read(file, bare), bare)
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
        packets=found.packets,
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


def readable_metadata(data: bytes) -> dict[str, Any]:
    """The metadata of a file; none where it is damaged or cut off."""
    try:
        return metadata(data)
    except (DamagedError, TruncatedError):
        return {}


def certain_splats(file: File, *, bare: bool = False) -> tuple[int, int]:
    """Counts the splats that the first bytes of a file hold, and those of the whole file.  decode with `partial` draws
    them.  Raises a subclass of FileError, or OSError."""
    content = read(file, bare)
    certain, total = ffi.new("uint32_t *"), ffi.new("uint32_t *")
    result = lib.gscl_certain_splats(content.buffer, content.size, read_settings(bare), certain, total)
    check(result, subject=content.name)
    return certain[0], total[0]
