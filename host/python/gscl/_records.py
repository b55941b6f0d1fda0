"""Records that calls return: what they have in common."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import Field, dataclass, fields
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy

from gscl._packets import Buffer

if TYPE_CHECKING:
    from typing_extensions import Self


@dataclass(frozen=True, eq=False, repr=False)
class Record:
    """Base of frozen dataclasses.

    Two records are equal if all their values are, where NaN, which stands for an unknown figure, equals NaN: a record equals
    its copies.  The text has numbers with six digits, and leaves out NaN and fields with repr=False; hash leaves out
    those with hash=False.
    """

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return [_comparable(value) for _, value in self._values()] == [_comparable(value) for _, value in other._values()]

    def __hash__(self) -> int:
        return hash(tuple(_comparable(value) for field, value in self._values() if field.hash is not False))

    def __repr__(self) -> str:
        shown = [f"{field.name}={_text(value)}" for field, value in self._values() if field.repr and not _is_nan(value)]
        return f"{type(self).__name__}({', '.join(shown)})"

    def _values(self) -> Iterator[tuple[Field[Any], Any]]:
        return ((field, getattr(self, field.name)) for field in fields(self))


Report = TypeVar("Report", bound=Record)


class Reported(bytes, Generic[Report]):
    """Base of the bytes of a file that have a report of how they were made."""

    report: Report

    def __new__(cls, data: Buffer, report: Report) -> Self:
        made = super().__new__(cls, data)
        made.report = report
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (bytes(self), self.report)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {len(self)} bytes, {self.report!r}>"

    def __str__(self) -> str:
        return repr(self)


def _is_nan(value: Any) -> bool:
    return isinstance(value, float) and math.isnan(value)


def _comparable(value: Any) -> Any:
    if isinstance(value, numpy.ndarray):
        return value.shape, str(value.dtype), value.tobytes()
    return None if _is_nan(value) else value


def _text(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else repr(value)
