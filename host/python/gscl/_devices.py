"""Devices, and the contexts that are kept open on them."""

from __future__ import annotations

import contextlib
import os
import threading
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from gscl._binding import ffi, lib
from gscl._errors import DeviceError, DeviceFailedError, Error, NoPlatformError, assign, check

HOST = "host"
"""The device that every machine has: the processor itself, with kernels that were compiled with the library.  It needs no
OpenCL, and starts at once."""


@dataclass(frozen=True)
class Device:
    """A device that encodes and decodes."""

    id: str
    """What the argument `device` takes: numbers of platform and device of OpenCL, as "0.0", or "host"."""
    name: str
    platform: str
    version: str
    is_gpu: bool
    is_default: bool
    why_default: str
    """One phrase; empty unless is_default."""
    compute_units: int
    """As OpenCL counts them; of "host" the threads that the process may run."""
    memory_bytes: int


def _text(array: Any) -> str:
    return str(ffi.string(array).decode("utf-8", "replace"))


class Devices(list[Device]):
    """What devices returns: a list, whose text has a line for each device, and says what is missing."""

    missing: str
    """Why there is no OpenCL device, and what to install for one; empty where there is one."""

    def __init__(self, found: Iterable[Device] = (), missing: str = "") -> None:
        super().__init__(found)
        self.missing = missing

    def __repr__(self) -> str:
        lines = [_line(device) for device in self]
        return "\n".join([*lines, self.missing] if self.missing else lines)


def _line(device: Device) -> str:
    units = "threads" if device.id == HOST else "compute units"
    text = f"{device.id}: {device.name}, {device.compute_units} {units}, {device.memory_bytes / 2**30:.1f} GiB"
    return f"{text}; the default: {device.why_default}" if device.is_default else text


def devices() -> Devices:
    """Lists all devices that encode: those of OpenCL, then "host", this processor.

    Where there is no OpenCL device, `missing` says why, and what to install.  Raises NoPlatformError, which says the same, where
    there is no device at all, because the library has no kernels for this processor either: then "host" only decodes.
    """
    try:
        found = _list()
    except NoPlatformError:
        raise NoPlatformError(
            'no device encodes: this build of gscl has no kernels for the processor, so that "host" only decodes (installing '
            f"gscl again with clang at hand adds them), and {_missing()}"
        ) from None
    return Devices(found, "" if any(device.id != HOST for device in found) else _missing())


def _missing() -> str:
    """Why there is no OpenCL device: what the library says when the first one is asked for; and what GPUs need."""
    try:
        _close(_open("0.0", 0))
    except DeviceError as error:
        if "built without OpenCL" in str(error):  # by -Dopencl=disabled
            return str(error)
        return f"{error}; a GPU needs the OpenCL of its driver: nvidia-opencl-icd, intel-opencl-icd, mesa-opencl-icd or others"
    return ""


def _list() -> list[Device]:
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
                _text(row.why_default),
                row.compute_units,
                row.memory_bytes,
            )
        )
        row = row.next
    lib.gscl_free(first[0])
    _pool.note_listed(found)
    return found


class _Pool:
    """Contexts that no call uses at the moment, by the name of their device and the setting of its threads.

    A context is used by one thread at a time, and keeps compiled kernels and buffers for the next call.

    Neither contexts nor OpenCL survive a fork, as their threads do not exist in the child; what is known about devices does,
    so that a child need not ask OpenCL for the default device.
    """

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.limit = 4  # contexts kept for each name
        self.idle: dict[tuple[str | None, int], list[Any]] = {}
        self.default: str | None = None  # the id of the default device, once devices were listed
        self.opencl_process = 0  # which found OpenCL devices, whose implementations have threads since then; 0: none yet

    def after_fork(self) -> None:
        """In a child process: forgets the contexts without touching them."""
        self.lock = threading.Lock()
        self.idle = {}

    def note_listed(self, found: list[Device]) -> None:
        self.default = next((device.id for device in found if device.is_default), None)
        if not self.opencl_process and any(device.id != HOST for device in found):
            self.opencl_process = os.getpid()

    def name(self, device: str | None) -> str | None:
        """The device, or the id of the default one; None where there is none.  Lists devices before OpenCL is used."""
        if device != HOST and self.default is None:
            try:
                _list()
            except NoPlatformError:
                pass  # opening tells more
        return self.default if device is None else device

    def take(self, device: str | None, threads: int) -> Any:
        """A context on a device of `name`."""
        with self.lock:
            idle = self.idle.get((device, threads))
            if idle:
                return idle.pop()
        if device != HOST and self.opencl_process not in (0, os.getpid()):
            raise DeviceFailedError(
                "OpenCL was in use before this process was forked: start processes with 'spawn', or use the device \"host\""
            )
        return _open(device, threads)

    def give(self, device: str | None, threads: int, context: Any) -> None:
        with self.lock:
            idle = self.idle.setdefault((device, threads), [])
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


def _open(device: str | None, threads: int) -> Any:
    settings = ffi.new("gscl_context_settings *")
    lib.gscl_context_settings_init(settings, ffi.sizeof("gscl_context_settings"))
    name = ffi.NULL if device is None else ffi.new("char[]", device.encode())
    settings.device = name
    assign(settings, "threads", threads)
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
def context_on(device: str | None, threads: int = 0) -> Iterator[Any]:
    """A context of the calling thread's own, with `threads` of the device "host"; 0: as many as the process may run.  It is
    not used again after an error of the device."""
    device = _pool.name(device)
    context = _pool.take(device, threads)
    try:
        yield context
    except DeviceError:
        _close(context)
        raise
    except BaseException:
        _pool.give(device, threads, context)
        raise
    _pool.give(device, threads, context)


def release_devices() -> None:
    """Closes the contexts that are kept for further calls, and so releases memory of the devices."""
    _pool.clear()


def keep_contexts(count: int) -> None:
    """Keeps at least so many contexts on each device, for as many threads that encode again and again."""
    _pool.limit = max(_pool.limit, count)
