"""OpenCL devices, and the contexts that are kept open on them."""

from __future__ import annotations

import contextlib
import os
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from gscl._binding import ffi, lib
from gscl._errors import DeviceError, DeviceFailedError, Error, check

HOST = "host"
"""The device that every machine has: the library itself, which decodes without OpenCL."""


@dataclass(frozen=True)
class Device:
    """An OpenCL device."""

    id: str
    """Numbers of platform and device, as "0.0": what the argument `device` takes."""
    name: str
    platform: str
    version: str
    is_gpu: bool
    is_default: bool
    compute_units: int
    memory_bytes: int


def _text(array: Any) -> str:
    return str(ffi.string(array).decode("utf-8", "replace"))


def devices() -> list[Device]:
    """Lists all OpenCL devices.  Raises NoPlatformError where there is none."""
    first = ffi.new("gscl_device_info **")
    check(lib.gscl_list_devices(first))
    found = []
    row = first[0]
    while row:
        found.append(
            Device(
                _text(row.id),
                _text(row.device_name),
                _text(row.platform_name),
                _text(row.device_version),
                row.is_gpu,
                row.is_default,
                row.compute_units,
                row.memory_bytes,
            )
        )
        row = row.next
    lib.gscl_free(first[0])
    return found


class _Pool:
    """Contexts that no call uses at the moment, by the name of their device.

    A context is used by one thread at a time, and keeps compiled kernels and buffers for the next call.
    """

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.limit = 4  # contexts kept for each name
        self.idle: dict[str | None, list[Any]] = {}
        self.opencl_process = 0  # in which a context on an OpenCL device was opened; 0: none yet

    def after_fork(self) -> None:
        """In a child process, where the threads of OpenCL do not exist: forgets the contexts without touching them."""
        self.lock = threading.Lock()
        self.idle = {}

    def take(self, device: str | None) -> Any:
        with self.lock:
            idle = self.idle.get(device)
            if idle:
                return idle.pop()
        if device != HOST and self.opencl_process not in (0, os.getpid()):
            raise DeviceFailedError("OpenCL was in use before this process was forked: start processes with 'spawn'")
        opened = _open(device)
        if device != HOST:
            self.opencl_process = os.getpid()
        return opened

    def give(self, device: str | None, context: Any) -> None:
        with self.lock:
            idle = self.idle.setdefault(device, [])
            if len(idle) < self.limit:
                idle.append(context)
                return
        _close(context)

    def clear(self) -> None:
        with self.lock:
            idle, self.idle = self.idle, {}
        for contexts in idle.values():
            for context in contexts:
                _close(context)


def _open(device: str | None) -> Any:
    settings = ffi.new("gscl_context_settings *")
    lib.gscl_context_settings_init(settings, ffi.sizeof("gscl_context_settings"))
    name = ffi.NULL if device is None else ffi.new("char[]", device.encode())
    settings.device = name
    pointer = ffi.new("gscl_context **")
    result = lib.gscl_context_create(pointer, settings)
    try:
        check(result, pointer[0])
    except Error:
        _close(pointer[0])
        raise
    return pointer[0]


def _close(context: Any) -> None:
    lib.gscl_context_free(ffi.new("gscl_context **", context))


_pool = _Pool()
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_pool.after_fork)


@contextlib.contextmanager
def context_on(device: str | None) -> Iterator[Any]:
    """A context of the calling thread's own.  It is not used again after an error of the device."""
    context = _pool.take(device)
    try:
        yield context
    except DeviceError:
        _close(context)
        raise
    except BaseException:
        _pool.give(device, context)
        raise
    _pool.give(device, context)


def release_devices() -> None:
    """Closes the contexts that are kept for further calls, and so releases memory of the devices."""
    _pool.clear()


def keep_contexts(count: int) -> None:
    """Keeps at least so many contexts on each device, for as many threads that encode again and again."""
    _pool.limit = max(_pool.limit, count)
