"""What a worker process uses of its machine: its device and its share of the cores."""

from __future__ import annotations

import itertools
import os
import tempfile
import threading
from typing import IO
from urllib.parse import quote

from gscl import _devices

_lock = threading.Lock()
_claims: dict[tuple[str, ...], tuple[str, IO[str]]] = {}


def prepare(encoders: int) -> None:
    """Before the first use of OpenCL: as many compute threads as the worker has encoders, where PoCL is the device,
    and a context for each encoder.  What the environment says already stays.  The threads of the device "host" are a setting of
    each encode."""
    for name in "POCL_MAX_PTHREAD_COUNT", "POCL_CPU_MAX_CU_COUNT":  # before and since PoCL 5
        os.environ.setdefault(name, str(encoders))
    _devices.keep_contexts(encoders)


def choose_device(devices: tuple[str, ...]) -> str | None:
    """This process's device: the same at each call, and shared evenly with the other workers of the machine.

    devices: ids or parts of names; empty for the GPUs of the platform that encoding takes by default or, if that takes
        no GPU, for the default.
    """
    with _lock:
        if not devices:
            devices = _gpus()
        if len(devices) < 2:
            return devices[0] if devices else None
        if devices not in _claims:
            _claims[devices] = _claim(devices)
        return _claims[devices][0]


def _gpus() -> tuple[str, ...]:
    found = _devices.devices()
    default = next((device for device in found if device.is_default), None)
    if default is None or not default.is_gpu:
        return ()
    return tuple(device.id for device in found if device.is_gpu and device.platform == default.platform)


def _claim(devices: tuple[str, ...]) -> tuple[str, IO[str]]:
    """The first place that is free, of one on each device, then a second on each, and so on.

    A place is a locked file.  The system releases it when the process ends, however it ends: the worker that replaces
    it takes the place.
    """
    import fcntl

    folder = os.path.join(tempfile.gettempdir(), f"gscl-devices-{os.getuid()}")
    os.makedirs(folder, mode=0o700, exist_ok=True)
    for place in itertools.count():
        for device in devices:
            file = open(os.path.join(folder, f"{quote(device, safe='')}-{place}"), "w", encoding="ascii")
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                return device, file
            except BlockingIOError:
                file.close()
    raise AssertionError("itertools.count ends")
