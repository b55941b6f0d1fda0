"""Exceptions: one for each result of the library that is not success."""

from __future__ import annotations

from typing import Any, ClassVar

from gscl._binding import ffi, lib


class Error(Exception):
    """Base class of all errors of the library.  Its text is the library's message."""

    code: ClassVar[int] = 0
    """The number of the result: a value of gscl_result in gscl/gscl.h."""


class InvalidArgumentError(Error, ValueError):
    """An argument is out of range."""

    code = 1


class OutOfMemoryError(Error, MemoryError):
    """The host has too little memory."""

    code = 2


class CancelledError(Error):
    """The progress callback returned False."""

    code = 3


class StructSizeError(Error, RuntimeError):
    """The library and this package do not fit together."""

    code = 4


class DeviceError(Error, RuntimeError):
    """Base class of errors of devices."""


class NoPlatformError(DeviceError):
    """There is no device that encodes: no OpenCL device, and the library has no kernels for this processor."""

    code = 10


class UnknownDeviceError(DeviceError, LookupError):
    """No device matches."""

    code = 11


class AmbiguousDeviceError(DeviceError, LookupError):
    """Several devices match; the message lists them."""

    code = 12


class DeviceMemoryError(DeviceError, MemoryError):
    """The device has too little memory for this picture."""

    code = 13


class DeviceFailedError(DeviceError):
    """An OpenCL call failed."""

    code = 14


class KernelBuildError(DeviceError):
    """The device's compiler rejected a kernel."""

    code = 15


class NoEncoderError(DeviceError):
    """The device is "host", and the library has no kernels for this processor: it only decodes there."""

    code = 16


class GroupSizeError(DeviceError):
    """The device has too small work-groups for a kernel."""

    code = 17


class FileError(Error, ValueError):
    """Base class of errors in gscl files."""


class NotGsclError(FileError):
    """Not a gscl file."""

    code = 20


class NewerVersionError(FileError):
    """The file is of a newer version of the format."""

    code = 21


class TruncatedError(FileError):
    """The file ends too early."""

    code = 22


class DamagedError(FileError):
    """The check at the end of the file does not match."""

    code = 23


class CorruptError(FileError):
    """The check matches, but the file breaks a rule of the format."""

    code = 24


class LimitError(FileError):
    """Decoding needs more than max_pixels or max_work; the message has the figures."""

    code = 25


class UnknownBlockError(FileError):
    """The file has a block that a reader must understand and this version does not."""

    code = 26


class OtherPictureError(FileError):
    """A packet of another picture than those before it."""

    code = 27


class ImageSizeError(Error, ValueError):
    """A picture without pixels, or with more than 16384 on a side."""

    code = 30


class ImageNotFiniteError(Error, ValueError):
    """The picture has NaN or infinite samples."""

    code = 31


class BudgetTooSmallError(Error, ValueError):
    """No file is so small; the message names the smallest possible size."""

    code = 40


class TargetUnreachableError(Error, ValueError):
    """No file reaches this quality, or it cannot be measured."""

    code = 41


class ConflictError(Error, ValueError):
    """Arguments that exclude each other."""

    code = 42


class FieldError(Error, ValueError):
    """A field of splats that the format does not have."""

    code = 43


def _leaves(kind: type[Error]) -> list[type[Error]]:
    below = [leaf for child in kind.__subclasses__() for leaf in _leaves(child)]
    return below or [kind]


_BY_CODE = {kind.code: kind for kind in _leaves(Error)}


def check(result: int, context: Any = None, subject: str = "") -> None:
    """Raises the exception of a result, unless it is success.  `subject` names the file."""
    if result == lib.GSCL_OK:
        return
    detail = lib.gscl_context_message(context) if context else ffi.NULL
    if not detail or detail[0] == b"\0":
        detail = lib.gscl_result_text(result)
    message = ffi.string(detail).decode("utf-8", "replace")
    raise _BY_CODE.get(result, Error)(f"{subject}: {message}" if subject else message)


def assign(struct: Any, field: str, value: Any, name: str = "") -> None:
    """Sets a field, and refuses numbers that its type does not hold."""
    try:
        setattr(struct, field, value)
    except OverflowError:
        raise InvalidArgumentError(f"{name or field}: {value} is out of range") from None


def set_target(settings: Any, targets: dict[int, tuple[str, float | None]]) -> None:
    """Sets the target of settings: the one that has a value, of names and values by the library's numbers."""
    chosen = [(number, name, value) for number, (name, value) in targets.items() if value is not None]
    if len(chosen) > 1:
        raise ConflictError("more than one target: " + ", ".join(name for _, name, _ in chosen))
    for number, _, value in chosen:
        settings.target = number
        settings.target_value = value
