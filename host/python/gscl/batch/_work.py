"""What a worker does: it encodes the pictures of a task, one after the other, and writes their rows."""

from __future__ import annotations

import io
import json
import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeVar

import distributed
from PIL import Image, UnidentifiedImageError

from gscl._encode import Encoded, encode
from gscl._errors import (
    AmbiguousDeviceError,
    DeviceError,
    FileError,
    NoEncoderError,
    NoPlatformError,
    UnknownDeviceError,
)
from gscl._inspect import info
from gscl.batch import _machine, _report, _storage
from gscl.batch._plan import printable
from gscl.batch._report import EXISTS, FAILED, OK, Row

Result = TypeVar("Result")

Encoder = Callable[..., Encoded]
"""Called with the bytes of a picture's file, and by name with `device` and the settings of the run."""

# Errors that each picture would have on this machine: the task fails, and Dask tries it on another one.
_OF_THE_MACHINE = (NoPlatformError, UnknownDeviceError, AmbiguousDeviceError, NoEncoderError)
# Errors of storage that trying again does not mend.
_LASTING = (FileNotFoundError, IsADirectoryError, NotADirectoryError, PermissionError, ValueError, ImportError)

PAUSE = 0.5  # seconds before the second attempt; doubled before each further one
_REPORT_INTERVAL = 1.0  # seconds between reports of progress


class TransientError(Exception):
    """Wraps an error that may not come again."""


@dataclass(frozen=True)
class Job:
    """What all tasks of a run share."""

    run: str
    out: str
    report: str
    settings: dict[str, Any] = field(default_factory=dict)
    encoder: Encoder | None = None
    devices: tuple[str, ...] = ()
    retries: int = 2
    overwrite: bool = False
    threads: int = 1
    """Of each encode on the device "host"."""

    def topic(self) -> str:
        """Of the events that tell the caller about progress."""
        return f"gscl-{self.run}"


def encode_file(picture: bytes, *, device: str | None, threads: int = 1, **settings: Any) -> Encoded:
    """The encoder of a run that has no other one.  It takes one thread, as workers have an encoder for each core."""
    try:
        image = Image.open(io.BytesIO(picture))
    except UnidentifiedImageError:
        raise UnidentifiedImageError("not an image that Pillow reads") from None
    with image:
        encoded: Encoded = encode(image, device=device, threads=threads, **settings)
        return encoded


def do_task(job: Job, task: str, lines: str) -> dict[str, int]:
    """Encodes the pictures of these lines of a plan, and returns what their rows count to.

    A task runs again where its worker died.  Then it finds the outputs that were written, or all rows.
    """
    url = _report.part_url(job.report, job.run, task)
    part = _report.read_part(url, ["status", "bytes"])
    if part is not None:
        return _report.count(part.to_pylist())
    worker, encoders, tell = _surroundings(job, task)
    _machine.prepare(encoders)
    device = _machine.choose_device(job.devices)
    rows = []
    for line in lines.splitlines():
        rows.append(do_picture(job, *json.loads(line), worker=worker, device=device))
        tell(len(rows))
    _report.write_part(url, rows, _storage.temporary_folder(job.report, job.run))
    return _report.count(rows)


def _surroundings(job: Job, task: str) -> tuple[str, int, Callable[[int], None]]:
    """The worker's name, how many tasks it runs at the same time, and a function that reports how many are done."""
    worker = distributed.get_worker()
    told = time.monotonic()

    def tell(done: int) -> None:
        nonlocal told
        if time.monotonic() - told >= _REPORT_INTERVAL:
            told = time.monotonic()
            worker.log_event(job.topic(), [task, done])

    return f"{worker.name} {worker.address}", worker.state.nthreads, tell


def do_picture(job: Job, source: str, output: str, error: str, *, worker: str, device: str | None) -> Row:
    """Encodes a picture, unless its output exists whole, and returns its row."""
    row = empty_row(source, output, worker)
    started = time.perf_counter()
    try:
        if error:
            raise ValueError(error)
        _complete(row, job, source, output, device)
    except _OF_THE_MACHINE:
        raise
    except Exception as reason:
        row["status"], row["error"] = FAILED, describe(reason)
    row["seconds"] = time.perf_counter() - started
    row["finished"] = time.time_ns() // 10**6
    return row


def empty_row(source: str, output: str, worker: str) -> Row:
    return Row(
        source=printable(source),
        output=printable(output),
        status=FAILED,
        error=None,
        source_bytes=None,
        bytes=None,
        width=None,
        height=None,
        splats=None,
        psnr=None,
        ssimulacra2=None,
        seconds=0.0,
        attempts=0,
        worker=worker,
        device=None,
        finished=time.time_ns() // 10**6,
    )


def describe(error: BaseException) -> str:
    """The class and the text of an error, in one line."""
    error = error.__cause__ if isinstance(error, TransientError) and error.__cause__ else error
    return printable(" ".join(f"{type(error).__name__}: {error}".split()))


def _complete(row: Row, job: Job, source: str, output: str, device: str | None) -> None:
    """Fills a row in, with up to 1 + `job.retries` attempts."""
    while True:
        row["attempts"] += 1
        try:
            if job.overwrite or not _exists(row, output, bool(job.settings.get("bare"))):
                _encode(row, job, source, output, device)
            return
        except TransientError:
            if row["attempts"] > job.retries:
                raise
        time.sleep(PAUSE * 2 ** (row["attempts"] - 1))


def _stored(function: Callable[[], Result]) -> Result:
    """Calls a function that reads or writes files, whose errors may pass."""
    try:
        return function()
    except _LASTING:
        raise
    except Exception as error:
        raise TransientError from error


def _exists(row: Row, output: str, bare: bool) -> bool:
    """Whether the output exists and is a whole gscl file."""
    try:
        data = _stored(lambda: _storage.read(output))
        found = info(data, bare=bare)
    except (FileNotFoundError, FileError):
        return False
    row["status"], row["bytes"], row["splats"] = EXISTS, len(data), found.splats
    row["width"], row["height"] = found.width, found.height
    return True


def _encode(row: Row, job: Job, source: str, output: str, device: str | None) -> None:
    picture = _stored(lambda: _storage.read(source))
    row["source_bytes"], row["device"] = len(picture), device or "default"
    try:
        if job.encoder:
            encoded = job.encoder(picture, device=device, **job.settings)
        else:
            encoded = encode_file(picture, device=device, threads=job.threads, **job.settings)
    except _OF_THE_MACHINE:
        raise
    except (DeviceError, MemoryError) as error:
        raise TransientError from error
    found, report = info(encoded, bare=bool(job.settings.get("bare")), header_only=True), encoded.report
    _stored(lambda: _storage.write_whole(output, encoded, _storage.temporary_folder(job.out, job.run)))
    row["status"], row["bytes"], row["splats"], row["psnr"] = OK, len(encoded), report.splats, report.psnr
    row["ssimulacra2"] = None if math.isnan(report.ssimulacra2) else report.ssimulacra2
    row["width"], row["height"] = found.width, found.height
