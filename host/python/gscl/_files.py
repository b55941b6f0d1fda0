"""Open files that callers pass."""

from __future__ import annotations

import io
import os
from typing import IO, Any, Protocol, TypeGuard, Union, cast


class BinaryFile(Protocol):
    """An open binary file: anything whose method `read` returns bytes."""

    def read(self, size: int = -1, /) -> bytes: ...


StoredFile = Union[str, "os.PathLike[str]", BinaryFile]
"""A file: its path, or open in binary mode, from where it stands."""


def is_file(value: Any) -> TypeGuard[BinaryFile]:
    return hasattr(value, "read")


def name_of(file: BinaryFile) -> str:
    return str(getattr(file, "name", ""))


def read_all(file: BinaryFile) -> bytes:
    """The rest of a file."""
    _require_binary(file, isinstance(file, io.TextIOBase))
    data = file.read()
    _require_binary(file, isinstance(data, str))
    return data


def read_stored(file: StoredFile) -> tuple[bytes, str]:
    """The bytes of a file, and its name for messages; "" where it has none.  Raises OSError."""
    if isinstance(file, (str, os.PathLike)):
        with open(file, "rb") as opened:
            return opened.read(), os.fspath(file)
    return read_all(file), name_of(file)


def with_seek(file: BinaryFile) -> IO[bytes]:
    """The file itself if it can seek, else its rest, in memory."""
    _require_binary(file, isinstance(file, io.TextIOBase))
    can_seek = getattr(file, "seekable", lambda: False)
    return cast("IO[bytes]", file) if can_seek() else io.BytesIO(read_all(file))


def _require_binary(file: BinaryFile, is_text: bool) -> None:
    if is_text:
        name = name_of(file)
        raise TypeError(f"{name + ': ' if name else ''}a file that is open as text; open it in binary mode, \"rb\"")
