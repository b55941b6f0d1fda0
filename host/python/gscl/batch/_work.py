"""What a worker does: it converts the files of a task, one after the other, and writes their rows."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import distributed

from gscl._errors import AmbiguousDeviceError, DeviceError, NoEncoderError, NoPlatformError, UnknownDeviceError
from gscl.batch import _machine, _report, _storage
from gscl.batch._conversions import Conversion, Figures
from gscl.batch._plan import printable
from gscl.batch._report import EXISTS, FAILED, OK, Row

Result = TypeVar("Result")

# Errors that each file would have on this machine: the task fails, and Dask tries it on another one.
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
    conversion: Conversion
    devices: tuple[str, ...] = ()
    retries: int = 2
    overwrite: bool = False
    threads: int = 1
    """Of each file on the device "host"."""

    def topic(self) -> str:
        """Of the events that tell the caller about progress."""
        return f"gscl-{self.run}"


def do_task(job: Job, task: str, lines: str) -> dict[str, int]:
    """Converts the files of these lines of a plan, and returns what their rows count to.

    A task runs again where its worker died.  Then it finds the outputs that were written, or all rows.
    """
    url = _report.part_url(job.report, job.run, task)
    part = _report.read_part(url, ["status", "bytes"])
    if part is not None:
        return _report.count(part.to_pylist())
    worker, encoders, tell = _surroundings(job, task)
    _machine.prepare(encoders)
    device = _machine.choose_device(job.devices) if job.conversion.has_device else None
    rows = []
    for line in lines.splitlines():
        rows.append(do_file(job, *json.loads(line), worker=worker, device=device))
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


def do_file(job: Job, source: str, output: str, error: str, *, worker: str, device: str | None) -> Row:
    """Converts a file, unless its output exists whole, and returns its row."""
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
            if job.overwrite or not _exists(row, job, output):
                _convert(row, job, source, output, device)
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


def _exists(row: Row, job: Job, output: str) -> bool:
    """Whether the output exists and is whole."""
    try:
        data = _stored(lambda: _storage.read(output))
    except FileNotFoundError:
        return False
    try:
        figures = job.conversion.examine(data)
    except ValueError:
        return False
    _fill_in(row, EXISTS, data, figures)
    return True


def _convert(row: Row, job: Job, source: str, output: str, device: str | None) -> None:
    data = _stored(lambda: _storage.read(source))
    row["source_bytes"] = len(data)
    row["device"] = (device or "default") if job.conversion.has_device else None
    try:
        made, figures = job.conversion.convert(data, source, device=device, threads=job.threads)
    except _OF_THE_MACHINE:
        raise
    except (DeviceError, MemoryError) as error:
        raise TransientError from error
    _stored(lambda: _storage.write_whole(output, made, _storage.temporary_folder(job.out, job.run)))
    _fill_in(row, OK, made, figures)


def _fill_in(row: Row, status: str, output: bytes, figures: Figures) -> None:
    row["status"], row["bytes"] = status, len(output)
    row["width"], row["height"], row["splats"] = figures.width, figures.height, figures.splats
    row["psnr"], row["ssimulacra2"] = figures.psnr, figures.ssimulacra2
