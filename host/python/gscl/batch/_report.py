"""The report of a batch: a folder of Parquet files, each of the rows of one task.

A file is named RUN-TASK.parquet and appears whole.  Runs are numbered, so that the row of a file that failed and
was tried again in a later run is the one of the file that sorts last.
"""

from __future__ import annotations

import io
import json
import re
import secrets
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypedDict

import numpy
import pyarrow  # type: ignore[import-untyped]
import pyarrow.compute  # type: ignore[import-untyped]
import pyarrow.parquet  # type: ignore[import-untyped]

from gscl._errors import ConflictError
from gscl.batch import _storage
from gscl.batch._plan import digest

SCHEMA = pyarrow.schema(
    [
        ("source", pyarrow.string()),
        ("output", pyarrow.string()),
        ("status", pyarrow.string()),
        ("error", pyarrow.string()),
        ("source_bytes", pyarrow.int64()),
        ("bytes", pyarrow.int64()),
        ("width", pyarrow.int32()),
        ("height", pyarrow.int32()),
        ("splats", pyarrow.int64()),
        ("psnr", pyarrow.float64()),
        ("ssimulacra2", pyarrow.float64()),
        ("seconds", pyarrow.float64()),
        ("attempts", pyarrow.int32()),
        ("worker", pyarrow.string()),
        ("device", pyarrow.string()),
        ("finished", pyarrow.timestamp("ms", tz="UTC")),
    ]
)
"""Columns of a report: gscl.batch.run explains them."""

OK, EXISTS, FAILED = "ok", "exists", "failed"

_PART = re.compile(r"(\d{4,})-[0-9a-f]+-[\d.]+\.parquet$")
_SETTINGS = "_settings.json"  # readers of Parquet skip names that begin with an underscore
_READERS = 16  # files of an object store are read at the same time


class Row(TypedDict):
    """A row before it is written: `finished` is in milliseconds."""

    source: str
    output: str
    status: str
    error: str | None
    source_bytes: int | None
    bytes: int | None
    width: int | None
    height: int | None
    splats: int | None
    psnr: float | None
    ssimulacra2: float | None
    seconds: float
    attempts: int
    worker: str
    device: str | None
    finished: int


def part_url(report: str, run: str, task: str) -> str:
    return _storage.join(report, f"{run}-{task}.parquet")


def write_part(url: str, rows: Sequence[Row], temporary: str) -> None:
    memory = io.BytesIO()
    pyarrow.parquet.write_table(pyarrow.Table.from_pylist([dict(row) for row in rows], SCHEMA), memory)
    _storage.write_whole(url, memory.getvalue(), temporary)


def _list(report: str) -> list[str]:
    """The names of all parts, in the order of their runs."""
    filesystem, path = _storage.open_url(report)
    try:
        paths = filesystem.ls(path, detail=False)
    except FileNotFoundError:
        return []
    found = [(match, each.rpartition("/")[2]) for each in paths if (match := _PART.search(each))]
    return [name for _, name in sorted((int(match[1]), name) for match, name in found)]


def read_part(url: str, columns: Sequence[str] | None = None) -> Any:
    """The table of one part, or None where there is no such part."""
    try:
        data = _storage.read(url)
    except FileNotFoundError:
        return None
    return pyarrow.parquet.read_table(io.BytesIO(data), columns=None if columns is None else list(columns))


def _read_parts(report: str, columns: Sequence[str] | None) -> Iterator[Any]:
    names = _list(report)
    with ThreadPoolExecutor(_READERS) as readers:
        for start in range(0, len(names), 64 * _READERS):
            urls = [_storage.join(report, name) for name in names[start : start + 64 * _READERS]]
            yield from readers.map(lambda url: read_part(url, columns), urls)


def read_report(report: str, columns: Sequence[str] | None = None) -> Any:
    """The rows of a report as a pyarrow.Table with each source once: the row of the last run that tried it.

    report: the URL of the report's folder; it may be in use.
    columns: those to read; None for all.

    Raises OSError where there is no report.
    """
    wanted = list(SCHEMA.names if columns is None else columns)
    tables = list(_read_parts(report, list(dict.fromkeys([*wanted, "source"]))))
    if not tables and not _storage.open_url(report)[0].exists(_storage.open_url(report)[1]):
        raise FileNotFoundError(f"{report}: there is no report")
    table = pyarrow.concat_tables(tables) if tables else SCHEMA.empty_table()
    sources = pyarrow.compute.dictionary_encode(table["source"]).combine_chunks()
    last = numpy.zeros(len(sources.dictionary), numpy.int64)
    numpy.maximum.at(last, sources.indices.to_numpy(), numpy.arange(table.num_rows))
    return (table if len(last) == table.num_rows else table.take(numpy.sort(last))).select(wanted)


def read_done(report: str) -> set[bytes]:
    """Digests of the sources that need no more work: about 100 bytes of memory each."""
    done: set[bytes] = set()
    for table in _read_parts(report, ["source", "status"]):
        for source, status in zip(table["source"].to_pylist(), table["status"].to_pylist()):
            if status == FAILED:
                done.discard(digest(source))
            else:
                done.add(digest(source))
    return done


def count(rows: Iterable[Row]) -> dict[str, int]:
    """How many rows have each status, and the sum of their bytes."""
    counts = {OK: 0, EXISTS: 0, FAILED: 0, "bytes": 0}
    for row in rows:
        counts[row["status"]] += 1
        counts["bytes"] += row["bytes"] or 0
    return counts


def next_run(report: str) -> str:
    """A name for a run that sorts after earlier ones, and differs from those of runs that start at the same time."""
    names = _list(report)
    number = 1 + max((int(name.partition("-")[0]) for name in names), default=0)
    return f"{number:04d}-{secrets.token_hex(4)}"


def check_settings(report: str, settings: dict[str, Any], temporary: str) -> None:
    """Keeps the settings of the first run beside its rows, and raises ConflictError for a later run that has others."""
    url = _storage.join(report, _SETTINGS)
    text = json.dumps(settings, indent=1, sort_keys=True, default=repr)
    try:
        earlier = json.loads(_storage.read(url))
    except FileNotFoundError:
        _storage.write_whole(url, text.encode(), temporary)
        return
    now = json.loads(text)
    names = sorted(name for name in {*now, *earlier} if now.get(name) != earlier.get(name))
    if names:
        pairs = ", ".join(f"{name} {earlier.get(name)!r}, now {now.get(name)!r}" for name in names)
        raise ConflictError(f"{report}: this report was begun with other settings: {pairs}; choose another folder")
