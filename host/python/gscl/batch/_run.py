"""A run: plans it, keeps the workers busy, and counts what they did."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import logging
import math
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import dask
import distributed

from gscl._errors import InvalidArgumentError
from gscl.batch import _report, _storage, _work
from gscl.batch._conversions import Conversion
from gscl.batch._plan import Plan, Sources, make_plan
from gscl.batch._work import Job

TASKS_AHEAD = 2  # tasks in the scheduler for each encoder, so that none waits for the next task
TASK_FILES = 100  # the most in a task
LAST_TASKS = 4  # tasks for each encoder that the rest of a run is divided into, so that all encoders end together
RECOUNT_INTERVAL = 5.0  # seconds after which the workers are counted again


class BatchProgress(NamedTuple):
    """State of a run, for its callback."""

    done: int
    total: int
    failed: int
    """Of the tasks that ended."""
    encoders: int
    """Of all workers: how many files they convert at the same time."""
    elapsed_s: float


@dataclass(frozen=True)
class Summary:
    """What a run did."""

    ok: int
    """Files whose outputs were written."""
    exists: int
    """Files whose outputs were there, and whole."""
    failed: int
    """Files that cannot be converted; their rows say why."""
    skipped: int
    """Files that the report had as done before this run."""
    repeated: int
    """Names that were given more than once."""
    bytes: int
    """Of the outputs of `ok` and `exists`."""
    seconds: float


def convert_all(
    conversion: Conversion,
    sources: Sources,
    out: str,
    report: str,
    *,
    client: distributed.Client | None,
    workers: int | None,
    encoders: int | None,
    threads: int | None,
    devices: Sequence[str],
    root: str | None,
    shard: tuple[int, int],
    retries: int,
    overwrite: bool,
    task_files: int,
    progress: Callable[[BatchProgress], None] | None,
) -> Summary:
    """Converts many files: gscl.batch.run explains the arguments."""
    if not 1 <= shard[0] <= shard[1] or retries < 0 or task_files < 1:
        raise InvalidArgumentError(f"shard {shard}, retries {retries}, task_files {task_files}: out of range")
    conversion.check(threads or 0)
    out, report = _storage.absolute(out), _storage.absolute(report)
    job = Job(_report.next_run(report), out, report, conversion, tuple(devices), retries, overwrite)
    settings = {"conversion": conversion.name, "out": out, **conversion.settings()}
    started = time.monotonic()
    try:
        _report.check_settings(report, settings, _storage.temporary_folder(report, job.run))
        with tempfile.TemporaryFile("w+", encoding="ascii", prefix="gscl-plan-") as file:
            is_done = set() if overwrite else _report.read_done(report)
            plan = make_plan(file, sources, out, conversion.suffix, root, shard, is_done)
            totals = {_report.OK: 0, _report.EXISTS: 0, _report.FAILED: 0, "bytes": 0}
            if plan.count:
                if client is None:
                    workers, encoders, share = _divide(plan.count, workers, encoders)
                    threads = threads or share
                job = dataclasses.replace(job, threads=threads or 1)
                with _connected(client, workers, encoders) as connected:
                    _Run(connected, job, plan, totals, task_files, progress).complete()
    finally:
        for folder in {out, report}:
            _storage.clean(folder, job.run)
    return Summary(skipped=plan.done, repeated=plan.repeated, seconds=time.monotonic() - started, **totals)


def _divide(files: int, workers: int | None, encoders: int | None) -> tuple[int, int, int]:
    """Processes on this machine, files that each converts at the same time, and threads for each file."""
    cores = dask.system.CPU_COUNT  # that this process may use
    workers = workers or max(1, cores // (encoders or 1))
    encoders = encoders or max(1, cores // workers)
    return workers, encoders, max(1, cores // min(workers * encoders, files))


@contextlib.contextmanager
def _connected(client: Any, workers: int | None, encoders: int | None) -> Iterator[Any]:
    """The client, or one of a cluster of this machine."""
    if client is not None:
        yield client
        return
    start_cluster: Any = distributed.LocalCluster  # has no types
    start_client: Any = distributed.Client
    with start_cluster(
        n_workers=workers,
        threads_per_worker=encoders,
        dashboard_address="127.0.0.1:0",
        silence_logs=logging.CRITICAL,
    ) as cluster:
        with start_client(cluster) as own:
            yield own


class _Run:
    """Submits tasks as others end, so that the scheduler has a few for each encoder whatever the number of files."""

    def __init__(
        self,
        client: Any,
        job: Job,
        plan: Plan,
        totals: dict[str, int],
        task_files: int,
        progress: Callable[[BatchProgress], None] | None,
    ) -> None:
        self.client, self.job, self.plan, self.totals = client, job, plan, totals
        self.task_files, self.progress = task_files, progress
        self.started = self.told = time.monotonic()
        self.encoders, self.counted = 0, -math.inf
        self.left = plan.count
        self.tasks = 0
        self.lines: dict[Any, tuple[str, str]] = {}  # the task and the files of a future
        self.suspects: list[tuple[str, str]] = []  # tasks of one file whose workers died, with others at work on them
        self.alone = False  # whether the task under way is a suspect, and the only one
        self.under_way: dict[str, int] = {}  # files done in tasks that have not ended

    def complete(self) -> None:
        """Returns when each file of the plan has a row, and `totals` has the sums of the rows."""
        self.client.subscribe_topic(self.job.topic(), self._hear)
        as_completed: Any = distributed.as_completed  # has no types
        futures = as_completed(loop=self.client.loop)
        try:
            self._fill(futures)
            while self.lines:
                self._wait(futures)
                self._fill(futures)
            # A worker dies with all its files.  Which of them kills it shows when each is the only one under way.
            self.alone = True
            for task, line in self.suspects:
                self._submit(futures, f"{task}.alone", line)
                self._wait(futures)
            self._tell()
        finally:
            self.client.unsubscribe_topic(self.job.topic())
            self.client.cancel(list(self.lines), force=True)

    def _hear(self, event: Any) -> None:
        task, done = event[1]
        self.under_way[task] = done

    def _fill(self, futures: Any) -> None:
        """Submits tasks as long as the scheduler has less than it should."""
        if time.monotonic() - self.counted >= RECOUNT_INTERVAL:
            self.encoders = sum(self.client.nthreads().values())
            self.counted = time.monotonic()
        encoders = max(1, self.encoders)
        while self.left and len(self.lines) < TASKS_AHEAD * encoders:
            size = min(self.task_files, math.ceil(self.left / (LAST_TASKS * encoders)))
            self._submit(futures, f"{self.tasks:06d}", self.plan.take(size))
            self.tasks += 1
            self.left -= size

    def _submit(self, futures: Any, task: str, lines: str) -> None:
        future = self.client.submit(
            _work.do_task,
            self.job,
            task,
            lines,
            key=f"{self.job.topic()}-{task}",
            retries=self.job.retries,
            pure=False,
        )
        self.lines[future] = task, lines
        futures.add(future)

    def _wait(self, futures: Any) -> None:
        """Waits for a task, or for the time to tell about progress."""
        while not futures.has_ready():
            self._tell()
            time.sleep(0.02)
        future = next(futures)
        task, lines = self.lines.pop(future)
        self.under_way.pop(task, None)
        error = future.exception()
        if error is None:
            self._add(future.result())
        elif not isinstance(error, distributed.KilledWorker):
            raise error
        elif lines.count("\n") > 1:
            # One of these files may kill the workers: each becomes a task of its own.
            for i, line in enumerate(lines.splitlines(keepends=True)):
                self._submit(futures, f"{task}.{i:06d}", line)
        elif not self.alone:
            self.suspects.append((task, lines))
        else:
            self._give_up(task, lines)

    def _give_up(self, task: str, line: str) -> None:
        """Writes the row of a file that kills each worker that tries it."""
        source, output, _ = json.loads(line)
        row = _work.empty_row(source, output, "")
        row["error"] = "the worker died of it, and so did others"
        row["attempts"] = 1 + int(dask.config.get("distributed.scheduler.allowed-failures"))
        folder = _storage.temporary_folder(self.job.report, self.job.run)
        _report.write_part(_report.part_url(self.job.report, self.job.run, task), [row], folder)
        self._add(_report.count([row]))

    def _add(self, counts: dict[str, int]) -> None:
        for name, value in counts.items():
            self.totals[name] += value

    def _tell(self) -> None:
        """Calls the callback, at most once a second but for the end."""
        now = time.monotonic()
        if self.progress is None or (now - self.told < 1 and self.lines):
            return
        self.told = now
        ended = sum(self.totals[name] for name in (_report.OK, _report.EXISTS, _report.FAILED))
        done = ended + sum(list(self.under_way.values()))
        failed = self.totals[_report.FAILED]
        self.progress(BatchProgress(done, self.plan.count, failed, self.encoders, now - self.started))
