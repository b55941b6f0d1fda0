"""Files of any fsspec URL, read and written whole."""

from __future__ import annotations

import os
import time
import uuid
from typing import Any

import fsspec  # type: ignore[import-untyped]
from fsspec.implementations.local import LocalFileSystem  # type: ignore[import-untyped]

# Protocols whose put is atomic: a reader sees the old object or the whole new one.
OBJECT_STORES = {"abfs", "abfss", "adl", "az", "gcs", "gs", "memory", "oci", "oss", "s3", "s3a"}

LEFTOVER_AGE = 24 * 3600  # seconds after which temporary files are those of a run that was killed


def open_url(url: str) -> tuple[Any, str]:
    """The filesystem of a URL, and the path in it."""
    filesystem, path = fsspec.core.url_to_fs(url)
    return filesystem, str(path)


def absolute(url: str) -> str:
    """The same for all machines: local paths from the root on, URLs with the usual name of their protocol."""
    if "::" in url:
        return url
    filesystem, path = open_url(url)
    return path if isinstance(filesystem, LocalFileSystem) else str(filesystem.unstrip_protocol(path))


def join(folder: str, *names: str) -> str:
    """A URL below a folder.  A URL may be chained: "zip://folder::s3://bucket/archive.zip"."""
    first, chain, rest = folder.partition("::")
    return "/".join([first.rstrip("/") if first.strip("/") else first, *names]) + chain + rest


def read(url: str) -> bytes:
    filesystem, path = open_url(url)
    return bytes(filesystem.cat_file(path))


def temporary_folder(root: str, run: str) -> str:
    """Where a run keeps unfinished files of a folder of outputs.  Readers skip names that begin with a dot."""
    return join(root, f".gscl-{run}")


def write_whole(url: str, data: bytes, temporary: str) -> None:
    """Writes a file that appears whole or not at all.

    Local files, and those of servers, are written in the folder `temporary`, which must be of the same filesystem, and
    moved. Object stores have no move, and need none.
    """
    filesystem, path = open_url(url)
    if isinstance(filesystem, LocalFileSystem):
        _write_local(path, data, open_url(temporary)[1])
    elif _puts_whole(filesystem):
        filesystem.pipe_file(path, data)
    else:
        unfinished = f"{open_url(temporary)[1]}/{uuid.uuid4().hex}"
        for folder in filesystem._parent(unfinished), filesystem._parent(path):
            filesystem.makedirs(folder, exist_ok=True)
        filesystem.pipe_file(unfinished, data)
        filesystem.mv(unfinished, path)


def _puts_whole(filesystem: Any) -> bool:
    """Whether to write at once.  fsspec's general move copies and removes, which is worth no more than a write."""
    protocols = filesystem.protocol if isinstance(filesystem.protocol, tuple) else (filesystem.protocol,)
    return bool(OBJECT_STORES & set(protocols)) or type(filesystem).mv is fsspec.AbstractFileSystem.mv


def _write_local(path: str, data: bytes, temporary: str) -> None:
    os.makedirs(temporary, exist_ok=True)
    unfinished = os.path.join(temporary, uuid.uuid4().hex)
    try:
        with open(unfinished, "xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())  # before a report says that it exists
        try:
            os.replace(unfinished, path)
        except FileNotFoundError:
            os.makedirs(os.path.dirname(path), exist_ok=True)
            os.replace(unfinished, path)
    except BaseException:
        if os.path.exists(unfinished):
            os.unlink(unfinished)
        raise


def clean(root: str, run: str) -> None:
    """Removes temporary files of a run, and of runs that were killed a day or more ago."""
    filesystem, path = open_url(root)
    if _puts_whole(filesystem) and not isinstance(filesystem, LocalFileSystem):
        return
    now = time.time()
    try:
        entries = filesystem.ls(path, detail=True)
    except OSError:
        return
    for entry in entries:
        name = str(entry["name"]).rstrip("/").rpartition("/")[2]
        is_left = name.startswith(".gscl-") and now - float(entry.get("mtime") or now) > LEFTOVER_AGE
        if name == f".gscl-{run}" or is_left:
            try:
                filesystem.rm(entry["name"], recursive=True)
            except OSError:
                pass  # a worker that was taken for dead writes there at this moment
