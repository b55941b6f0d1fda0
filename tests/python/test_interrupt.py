"""Progress, cancelling, interrupts and threads."""

import signal
import subprocess
import sys
import threading
import time

import numpy
import pytest

import gscl

LIMIT = 1800  # seconds: it ends what hangs, however loaded the machine


class Counter(threading.Thread):
    """Counts as long as it gets the interpreter's lock."""

    def __init__(self):
        super().__init__(daemon=True)
        self.count = 0
        self.stopped = False

    def run(self):
        while not self.stopped:
            self.count += 1
            time.sleep(0.0002)


@pytest.fixture
def counter():
    """A counter beside a thread that gives the lock away only when it waits or calls the library."""
    interval = sys.getswitchinterval()
    thread = Counter()
    thread.start()
    while not thread.count:
        time.sleep(0.01)
    sys.setswitchinterval(1000)
    yield thread
    sys.setswitchinterval(interval)
    thread.stopped = True
    thread.join()


def in_thread(function):
    """Calls a function outside the main thread, where encode has no thread of its own."""
    results = []
    thread = threading.Thread(target=lambda: results.append(function()))
    thread.start()
    thread.join(LIMIT)
    return results[0]


def counted(counter, function):
    """How far the counter came during a call."""

    def run():
        before = counter.count
        function()
        return counter.count - before

    return in_thread(run)


def test_encode_releases_the_lock(counter, picture):
    assert counted(counter, lambda: gscl.encode(picture)) > 20


def test_decode_releases_the_lock(counter, data):
    assert counted(counter, lambda: gscl.decode(data, size=(6000, 4000), device="host")) > 20


def test_progress(picture):
    states = []
    gscl.encode(picture, effort=0, progress=states.append)
    fractions = [state.fraction for state in states]
    assert len(states) > 3 and fractions == sorted(fractions) and 0 <= fractions[0] and fractions[-1] <= 1
    assert states[-1].splats > 0 and states[-1].elapsed_s > 0


def test_progress_in_the_calling_thread(picture):
    def threads():
        found = set()
        gscl.encode(picture, effort=0, progress=lambda state: found.add(threading.get_ident()))
        return found == {threading.get_ident()}

    assert threads() and in_thread(threads)


@pytest.mark.parametrize("run", [lambda function: function(), in_thread], ids=["main", "other"])
def test_cancel(picture, data, run):
    calls = []

    def cancel(state):
        calls.append(state)
        return len(calls) < 3

    def encode():
        with pytest.raises(gscl.CancelledError, match="cancelled"):
            gscl.encode(picture, effort=0, progress=cancel)
        return len(calls)

    assert run(encode) == 3
    assert gscl.encode(picture, effort=0, bytes=400) == data


@pytest.mark.parametrize("device", ["host", None], ids=["host", "default"])
def test_progress_of_a_decode(data, device):
    states = []
    size = (3000, 2000)
    drawn = gscl.decode(data, size=size, device=device, progress=states.append)
    fractions = [state.fraction for state in states]
    assert len(states) > 2 and fractions == sorted(fractions) and 0 <= fractions[0] and fractions[-1] <= 1
    assert {state.splats for state in states} == {gscl.info(data).splats}
    assert numpy.array_equal(drawn, gscl.decode(data, size=size, device=device))
    with pytest.raises(gscl.CancelledError, match="cancelled"):
        gscl.decode(data, size=size, device=device, progress=lambda state: False)


@pytest.mark.parametrize("run", [lambda function: function(), in_thread], ids=["main", "other"])
def test_exception_in_progress(picture, run):
    def fail(state):
        raise ZeroDivisionError("in the callback")

    def encode():
        with pytest.raises(ZeroDivisionError, match="in the callback"):
            gscl.encode(picture, effort=0, progress=fail)
        return True

    assert run(encode)


def test_encode_within_progress(picture, data):
    """On a context of its own."""
    inner = []

    def encode(state):
        if not inner:
            inner.append(gscl.encode(picture, effort=0, bytes=400))

    assert gscl.encode(picture, effort=0, bytes=400, progress=encode) == data
    assert inner == [data]


def test_several_threads(picture, data):
    results = []

    def work():
        for _ in range(2):
            encoded = gscl.encode(picture, effort=0, bytes=400)
            results.append((encoded, gscl.decode(encoded).tobytes()))

    threads = [threading.Thread(target=work) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(LIMIT)
    assert results == [(data, gscl.decode(data).tobytes())] * 6


INTERRUPTED = """
import gc, signal, sys, threading, time
import numpy, gscl
from gscl import _decode, _encode

gc.disable()  # Python drops an interrupt that meets a finaliser
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
outcomes = []

def record(module, name):
    run = getattr(module, name)

    def recorded(*arguments):
        try:
            return run(*arguments)
        except BaseException as error:
            outcomes.append(type(error))
            raise

    setattr(module, name, recorded)

def say_when_working():
    while not any(thread.name == "gscl" and thread.is_alive() for thread in threading.enumerate()):
        time.sleep(0.01)
    print("working", flush=True)

picture = numpy.load(sys.argv[1])
progress = print if sys.argv[3] == "progress" else None
expected = gscl.encode(picture, effort=0, bytes=400)
record(_decode, "_draw")
record(_encode, "_run")
threading.Thread(target=say_when_working, daemon=True).start()
try:
    if sys.argv[2] == "encode":
        gscl.encode(numpy.tile(picture, (8, 8, 1)), effort=9, progress=progress)
    else:
        gscl.decode(expected, size=(16384, 16384), device="host", progress=progress)  # a second or more
    sys.exit("was not interrupted")
except KeyboardInterrupt:
    print("interrupted", flush=True)
for thread in threading.enumerate():
    if thread is not threading.current_thread():
        thread.join()
assert outcomes == [gscl.CancelledError], outcomes
assert gscl.encode(picture, effort=0, bytes=400) == expected
assert gscl.decode(expected).any()
print("undamaged", flush=True)
"""


@pytest.mark.parametrize("callback", ["progress", "none"])
@pytest.mark.parametrize("call", ["encode", "decode"])
def test_ctrl_c(tmp_path, picture, call, callback):
    """One interrupt ends the call with KeyboardInterrupt, and the library works as before."""
    path = tmp_path / "picture.npy"
    numpy.save(path, picture)
    command = [sys.executable, "-c", INTERRUPTED, str(path), call, callback]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            while process.stdout.readline() not in ("working\n", ""):
                pass
            process.send_signal(signal.SIGINT)
            output, errors = process.communicate(timeout=LIMIT)
        finally:
            process.kill()  # a call that ignores the interrupt must not outlast its test
    assert (process.returncode, errors) == (0, "")
    assert output.split()[-2:] == ["interrupted", "undamaged"]
