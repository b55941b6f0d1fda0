"""Progress of the library's calls, cancelling and interrupts."""

from __future__ import annotations

import contextlib
import queue
import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, NamedTuple, Optional, TypeVar

from gscl._binding import ffi, lib

Result = TypeVar("Result")


class Progress(NamedTuple):
    """State of an encode or a decode, for its callback."""

    fraction: float
    """Of the expected work, 0..1; never decreases."""
    psnr: float
    """dB of the current fit; 0 while unknown, and in a decode."""
    splats: int
    elapsed_s: float
    remaining_s: float
    """Seconds until it ends, an estimate; infinite while nothing is known, and 0 only at the end."""


ProgressCallback = Callable[[Progress], Optional[bool]]
"""Called in the thread that calls encode or decode.  Returning False cancels; an exception cancels, and is raised."""


class _Call(threading.local):
    """The callback of the call of the library that runs in a thread, and the exception that ended it."""

    progress: ProgressCallback | None = None
    exception: BaseException | None = None


_call = _Call()


def _keep_exception(kind: Any, exception: BaseException, traceback: Any) -> None:
    _call.exception = exception


@ffi.def_extern(error=False, onerror=_keep_exception)  # type: ignore[untyped-decorator]
def gscl_python_progress(opaque: Any, state: Any) -> bool:
    assert _call.progress is not None
    now = Progress(state.fraction, state.psnr, state.splats, state.elapsed_s, state.remaining_s)
    return _call.progress(now) is not False


def call(settings: Any, progress: ProgressCallback | None, function: Callable[[], int]) -> int:
    """Calls a function of the library that reads these settings.  Raises what the callback raises."""
    if progress is not None:
        settings.progress = lib.gscl_python_progress
    outer = _call.progress, _call.exception  # of a call whose callback calls the library
    _call.progress, _call.exception = progress, None
    try:
        result = function()
        exception = _call.exception
    finally:
        _call.progress, _call.exception = outer
    if exception is not None:
        raise exception
    return result


INTERRUPT_GRACE = 0.5  # seconds that an interrupted call waits for its work to stop


def interruptible(work: Callable[[Optional[ProgressCallback]], Result], progress: ProgressCallback | None) -> Result:
    """Calls `work`, so that an interrupt ends it.

    Python handles interrupts in the main thread, between its own instructions.  There the work has a thread of its own;
    the main thread waits for it and calls `progress`.  After an interrupt the work is cancelled; where it does not stop at
    once, because a kernel is being compiled, it ends later and its result is dropped.
    """
    if threading.current_thread() is not threading.main_thread():
        return work(progress)
    events: queue.SimpleQueue[Progress | Future[Result]] = queue.SimpleQueue()
    answers: queue.SimpleQueue[bool] = queue.SimpleQueue()
    stopped = threading.Event()

    def ask(state: Progress) -> bool:
        if progress is None or stopped.is_set():
            return not stopped.is_set()
        events.put(state)
        return answers.get()

    def run() -> None:
        done: Future[Result] = Future()
        try:
            done.set_result(work(ask))
        except BaseException as error:
            done.set_exception(error)
        events.put(done)

    worker = threading.Thread(target=run, name="gscl")
    try:
        worker.start()
        while not isinstance(event := events.get(), Future):
            assert progress is not None
            answers.put(progress(event) is not False)
        return event.result()
    except BaseException:
        stopped.set()
        answers.put(False)
        with contextlib.suppress(RuntimeError):  # it has not started yet, and ends when it asks
            worker.join(INTERRUPT_GRACE)
        raise
