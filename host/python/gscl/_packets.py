"""Packets: parts of a picture of which each can be drawn by itself, and lists of them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Union

from gscl._binding import ffi, lib
from gscl._errors import check

Buffer = Union[bytes, bytearray, memoryview]

_MAGIC = b"\xc7gs"  # of files and of lists; no packet begins with its first byte


def join(packets: Iterable[Buffer]) -> bytes:
    """A list of packets, as a file has it, without those that are empty or too large; b"" where none is left."""
    joined, size = ffi.new("uint8_t **"), ffi.new("size_t *")
    try:
        for packet in packets:
            content = ffi.from_buffer("uint8_t[]", packet)
            result = lib.gscl_append_packet(joined, size, content, len(content))
            if result != lib.GSCL_ERROR_INVALID_ARGUMENT:  # for a size that no packet has
                check(result)
        return bytes(ffi.buffer(joined[0], size[0])) if joined[0] else b""
    finally:
        lib.gscl_free(joined[0])


def split(packets: bytes) -> list[bytes]:
    """The packets of a list."""
    content = ffi.from_buffer("uint8_t[]", packets)
    position, packet, size = ffi.new("size_t *"), ffi.new("uint8_t **"), ffi.new("size_t *")
    found = []
    while lib.gscl_next_packet(content, len(content), position, packet, size):
        found.append(bytes(ffi.buffer(packet[0], size[0])))
    return found


def is_packet(data: Buffer) -> bool:
    """Whether these bytes are a packet, not a file or a list."""
    if bytes(data[:3]) == _MAGIC:
        return False
    content = ffi.from_buffer("uint8_t[]", data)
    info = ffi.new("gscl_packet_info *", {"struct_size": ffi.sizeof("gscl_packet_info")})
    return bool(lib.gscl_packet_probe(content, len(content), info) == lib.GSCL_OK)
