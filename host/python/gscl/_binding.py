"""The library: `ffi` and `lib`, as cffi makes them of its headers.

Without an OpenCL loader on the machine it is the library without OpenCL, which decodes and inspects only.
"""

try:
    from gscl._gscl import ffi, lib
except ImportError as reason:
    if "OpenCL" not in str(reason):
        raise
    from gscl._gscl_host import ffi, lib

__all__ = ["ffi", "lib"]
