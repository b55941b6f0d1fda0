"""Which files a run converts, in a temporary file of the caller's machine: a line for each."""

from __future__ import annotations

import hashlib
import itertools
import json
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import IO, Union

import fsspec  # type: ignore[import-untyped]
from fsspec.implementations.local import LocalFileSystem  # type: ignore[import-untyped]
from fsspec.utils import glob_translate  # type: ignore[import-untyped]

from gscl.batch import _storage

Sources = Union[str, Iterable[str]]
"""A glob ("s3://bucket/photos/**/*.jpg"), a manifest (a file of one URL or path a line), or URLs and paths."""

_GLOB = re.compile(r"[*?\[]")
_SUFFIX = re.compile(r"(?<=.)(\.pth\.tar|\.[^.]*)\Z")  # a checkpoint has two


def printable(name: str) -> str:
    """A name as reports hold it: in UTF-8, which names of local files need not be."""
    return name.encode("utf-8", "backslashreplace").decode()


def digest(name: str) -> bytes:
    """16 bytes that stand for a name, so that a million names take little memory."""
    return hashlib.blake2b(printable(name).encode(), digest_size=16).digest()


def list_sources(sources: Sources) -> Iterator[str]:
    """The URLs or paths of all files, one after the other.  Raises OSError."""
    if not isinstance(sources, str):
        yield from sources
    elif _GLOB.search(sources):
        yield from _match(sources)
    else:
        with fsspec.open(sources, "rt", encoding="utf-8", errors="surrogateescape", compression="infer") as lines:
            first = lines.readlines(4096)
            if any("\0" in line for line in first):  # as a picture has
                raise OSError(f"{sources} is no text with a name in each line")
            yield from (name for name in (line.rstrip("\r\n") for line in itertools.chain(first, lines)) if name)


def _match(pattern: str) -> Iterator[str]:
    """Files that match a glob, folder by folder, as fsspec's own glob keeps all of them in memory."""
    first, chain, rest = pattern.partition("::")
    filesystem, path = _storage.open_url(pattern)
    fixed = path[: _GLOB.search(path).start()] if _GLOB.search(path) else path  # type: ignore[union-attr]
    folder = fixed.rpartition("/")[0] or filesystem.root_marker
    depth = None if "**" in path else path.count("/") - folder.rstrip("/").count("/")
    matches = re.compile(glob_translate(path)).match
    scheme = first.partition("://")[0] if "://" in first else ""
    for parent, folders, files in filesystem.walk(folder, maxdepth=depth):
        folders.sort() if isinstance(folders, list) else None
        for name in sorted(files):
            found = f"{parent.rstrip('/')}/{name}" if parent else name
            if not matches(found):
                continue
            if isinstance(filesystem, LocalFileSystem):
                yield found
            elif chain:
                yield f"{scheme}://{found}{chain}{rest}"
            else:
                yield str(filesystem.unstrip_protocol(found))


def default_root(sources: Sources) -> str:
    """The folder that a glob begins with; "" for lists."""
    if not isinstance(sources, str) or not (found := _GLOB.search(sources)):
        return ""
    first, chain, rest = sources.partition("::")
    return first[: found.start()].rpartition("/")[0] + chain + rest


def locate(name: str, root: str, suffix: str) -> tuple[str, str]:
    """The URL or absolute path of a file, and the name of its output in the folder of outputs: that of the file below
    `root`, or all of it if it is elsewhere, with another suffix.  A relative name is one below `root`, or the current
    folder.  Raises ValueError.
    """
    first, chain, rest = name.partition("::")
    if "://" not in first and not first.startswith("/"):
        source, below = _storage.absolute(_storage.join(root, name) if root else name), first
    else:
        folder = root.partition("::")[0].rstrip("/") + "/"
        source = _storage.absolute(name)
        first = source.partition("::")[0]
        below = first[len(folder) :] if root and first.startswith(folder) else first.rpartition("://")[2]
    parts = [part for part in below.split("/") if part not in ("", ".")]
    if ".." in parts or not parts:
        raise ValueError("the name leads out of the folder of outputs: expected one without '..'")
    return source, "/".join([*parts[:-1], _SUFFIX.sub("", parts[-1]) + suffix])


@dataclass
class Plan:
    """What remains to be done, and what does not.  Each line of `file` is a JSON array: source, output, error."""

    file: IO[str]
    count: int = 0
    done: int = 0
    """Files whose row of an earlier run says that they are done."""
    repeated: int = 0
    """Names that were given more than once."""
    seen: dict[bytes, bytes] = field(default_factory=dict, repr=False)

    def add(self, source: str, output: str, error: str = "") -> None:
        self.file.write(json.dumps([source, output, error]) + "\n")
        self.count += 1

    def take(self, count: int) -> str:
        """The next lines of the plan, at most `count`."""
        return "".join(line for _, line in zip(range(count), self.file))


def make_plan(
    file: IO[str],
    sources: Sources,
    out: str,
    suffix: str,
    root: str | None,
    shard: tuple[int, int],
    is_done: set[bytes],
) -> Plan:
    """Lists the sources of this shard, each once, in an empty file.  Two that would have the same output are not both
    converted: the second gets an error.  Takes about 200 bytes of memory for each while it works, and none afterwards.
    """
    root = default_root(sources) if root is None else root
    root = _storage.absolute(root) if root else ""
    plan = Plan(file)
    index, count = shard
    for given in list_sources(sources):
        try:
            (source, name), error = locate(given, root, suffix), ""
        except ValueError as reason:
            source, name, error = given, "", str(reason)
        key, own = digest(name or source), digest(source)
        if int.from_bytes(key[:8], "little") % count != index - 1:
            continue
        if key in plan.seen:
            if plan.seen[key] == own[:8]:
                plan.repeated += 1
                continue
            error = f"another file has the output {name}, too: rename one of them"
        else:
            plan.seen[key] = own[:8]
        if not error and own in is_done:
            plan.done += 1
        else:
            plan.add(source, _storage.join(out, name) if name else "", error)
    plan.seen = {}
    plan.file.seek(0)
    return plan
