"""The library: `ffi` and `lib`, as cffi makes them of its headers."""

from gscl._gscl import ffi, lib

__all__ = ["ffi", "lib"]
