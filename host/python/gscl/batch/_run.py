"""A run: plans it, keeps the workers busy, and counts what they did."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import logging
import math
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import dask
import distributed
import numpy

from gscl._encode import encode
from gscl._devices import HOST
from gscl._errors import BudgetTooSmallError, CancelledError, InvalidArgumentError, NoEncoderError, TargetUnreachableError
from gscl.batch import _report, _storage, _work
from gscl.batch._plan import Pictures, Plan, make_plan
from gscl.batch._work import Encoder, Job

TASKS_AHEAD = 2  # tasks in the scheduler for each encoder, so that none waits for the next task
TASK_PICTURES = 100  # the most in a task
LAST_TASKS = 4  # tasks for each encoder that the rest of a run is divided into, so that all encoders end together
RECOUNT_INTERVAL = 5.0  # seconds after which the workers are counted again


class BatchProgress(NamedTuple):
    """State of a run, for its callback."""

    done: int
    total: int
    failed: int
    """Of the tasks that ended."""
    encoders: int
    """At work on all workers."""
    elapsed_s: float


@dataclass(frozen=True)
class Summary:
    """What a run did."""

    ok: int
    """Pictures encoded."""
    exists: int
    """Pictures whose outputs were there, and whole."""
    failed: int
    """Pictures that cannot be encoded; their rows say why."""
    skipped: int
    """Pictures that the report had as done before this run."""
    repeated: int
    """Names that were given more than once."""
    bytes: int
    """Of the outputs of `ok` and `exists`."""
    seconds: float


def run(
    pictures: Pictures,
    out: str,
    report: str,
    *,
    client: distributed.Client | None = None,
    workers: int | None = None,
    encoders: int | None = None,
    threads: int | None = None,
    devices: tuple[str, ...] | list[str] = (),
    root: str | None = None,
    shard: tuple[int, int] = (1, 1),
    retries: int = 2,
    overwrite: bool = False,
    task_pictures: int = TASK_PICTURES,
    encoder: Encoder | None = None,
    progress: Callable[[BatchProgress], None] | None = None,
    **settings: Any,
) -> Summary:
    """Encodes many pictures on the workers of a Dask cluster.

    pictures: a glob, a manifest, or a list, whose names are paths or URLs of fsspec.  A glob begins at its first "*",
        "?" or "[", and "**" stands for any folders; a manifest is a UTF-8 text, or a compressed one, with a name in
        each line.
    out: the folder of the outputs, which keeps the tree of the pictures: NAME.gscl for NAME.png.
    report: the folder of the report, which read_report reads.  It has a row a picture: source, output; status: "ok",
        "exists" (the output was there, and whole) or "failed"; error; source_bytes, bytes; width, height, splats, psnr;
        ssimulacra2, where it is the target; seconds, attempts, worker, device, and the time when it was finished.
    client: of the cluster; None starts worker processes on this machine for the time of the call.
    workers, encoders: with no client, how many processes, and how many pictures each encodes at the same time; None
        for as many as the machine has cores, in all.  With a client, each worker has as many encoders as Dask gave it
        threads.
    threads: of each encode on the device "host".  None for one, as other pictures take the other cores; where no client is
        given and pictures are fewer than encoders, for an even share of the cores.  An encoder of the caller's own does
        not get it.
    devices: ids or parts of names of OpenCL devices, which the workers of a machine share evenly, or "host"; empty for the
        GPUs of the default platform or, if it has none, the default device, which is "host".
    root: the folder in `pictures` that `out` stands for.  Relative names of a manifest are below it.  None for the
        folder that a glob begins with and, with a manifest, for the current folder; names elsewhere keep their whole
        path.
    shard: (i, n) for the i-th of n parts, 1..n, of all pictures.
    retries: further attempts for errors that may pass: those of storage and of OpenCL.
    overwrite: whether to encode pictures again whose outputs exist or whose rows say that they are done.
    task_pictures: the most pictures in a task, and rows in a file of the report.
    encoder: replaces gscl.encode; called with the bytes of a picture's file and, by name, `device` and the settings;
        returns what gscl.encode returns, or gscl.Encoded(data, report).
    progress: called about once a second, in the calling thread.  An exception in it ends the run.
    settings: arguments of gscl.encode.

    A picture that cannot be encoded is a row, and the run goes on.  A run that ended early, in whatever way, is
    completed by the same call: pictures whose rows say that they are done, or whose outputs are whole, are not encoded
    again; failed ones are.  Outputs and files of the report are written whole or not at all.

    Raises a subclass of gscl.Error for settings that no picture can have and for machines without a device, and OSError
    where names cannot be listed or the report not be written.
    """
    if not 1 <= shard[0] <= shard[1] or retries < 0 or task_pictures < 1:
        raise InvalidArgumentError(f"shard {shard}, retries {retries}, task_pictures {task_pictures}: out of range")
    if encoder is None:
        _check_settings({"threads": threads or 0, **settings})
    out, report = _storage.absolute(out), _storage.absolute(report)
    job = Job(_report.next_run(report), out, report, settings, encoder, tuple(devices), retries, overwrite)
    started = time.monotonic()
    try:
        _report.check_settings(report, {"out": out, **settings}, _storage.temporary_folder(report, job.run))
        with tempfile.TemporaryFile("w+", encoding="ascii", prefix="gscl-plan-") as file:
            plan = make_plan(file, pictures, out, root, shard, set() if overwrite else _report.read_done(report))
            totals = {_report.OK: 0, _report.EXISTS: 0, _report.FAILED: 0, "bytes": 0}
            if plan.count:
                if client is None:
                    workers, encoders, share = _divide(plan.count, workers, encoders)
                    threads = threads or share
                job = dataclasses.replace(job, threads=threads or 1)
                with _connected(client, workers, encoders) as connected:
                    _Run(connected, job, plan, totals, task_pictures, progress).complete()
    finally:
        for folder in {out, report}:
            _storage.clean(folder, job.run)
    return Summary(skipped=plan.done, repeated=plan.repeated, seconds=time.monotonic() - started, **totals)


def _check_settings(settings: Mapping[str, Any]) -> None:
    """Raises what every picture would raise.  The library checks settings before anything else of an encode, which ends
    there: by the callback, or because "host" has no kernels, or because of a target that only a picture of this size
    misses."""
    try:
        encode(numpy.zeros((8, 8), numpy.uint8), device=HOST, progress=lambda state: False, **settings)
    except (CancelledError, NoEncoderError, BudgetTooSmallError, TargetUnreachableError):
        pass


def _divide(pictures: int, workers: int | None, encoders: int | None) -> tuple[int, int, int]:
    """Processes on this machine, pictures that each encodes at the same time, and threads for each picture."""
    cores = dask.system.CPU_COUNT  # that this process may use
    workers = workers or max(1, cores // (encoders or 1))
    encoders = encoders or max(1, cores // workers)
    return workers, encoders, max(1, cores // min(workers * encoders, pictures))


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
    """Submits tasks as others end, so that the scheduler has a few for each encoder whatever the number of pictures."""

    def __init__(
        self,
        client: Any,
        job: Job,
        plan: Plan,
        totals: dict[str, int],
        task_pictures: int,
        progress: Callable[[BatchProgress], None] | None,
    ) -> None:
        self.client, self.job, self.plan, self.totals = client, job, plan, totals
        self.task_pictures, self.progress = task_pictures, progress
        self.started = self.told = time.monotonic()
        self.encoders, self.counted = 0, -math.inf
        self.left = plan.count
        self.tasks = 0
        self.lines: dict[Any, tuple[str, str]] = {}  # the task and the pictures of a future
        self.suspects: list[tuple[str, str]] = []  # tasks of one picture whose workers died, with others at work on them
        self.alone = False  # whether the task under way is a suspect, and the only one
        self.under_way: dict[str, int] = {}  # pictures done in tasks that have not ended

    def complete(self) -> None:
        """Returns when each picture of the plan has a row, and `totals` has the sums of the rows."""
        self.client.subscribe_topic(self.job.topic(), self._hear)
        as_completed: Any = distributed.as_completed  # has no types
        futures = as_completed(loop=self.client.loop)
        try:
            self._fill(futures)
            while self.lines:
                self._wait(futures)
                self._fill(futures)
            # A worker dies with all its pictures.  Which of them kills it shows when each is the only one under way.
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
            size = min(self.task_pictures, math.ceil(self.left / (LAST_TASKS * encoders)))
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
            # One of these pictures may kill the workers: each becomes a task of its own.
            for i, line in enumerate(lines.splitlines(keepends=True)):
                self._submit(futures, f"{task}.{i:06d}", line)
        elif not self.alone:
            self.suspects.append((task, lines))
        else:
            self._give_up(task, lines)

    def _give_up(self, task: str, line: str) -> None:
        """Writes the row of a picture that kills each worker that tries it."""
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
