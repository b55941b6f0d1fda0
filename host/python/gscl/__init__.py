"""gscl: an image codec that stores an image as a set of 2D Gaussians ("splats").

    import gscl
    encoded = gscl.encode("photo.jpg", bytes=2000)  # the bytes of a file, and encoded.report
    array = gscl.decode(encoded, size=(1536, 1024))

Importing it also registers a plugin of Pillow: PIL.Image.open("photo.gscl"), image.save("photo.gscl", bytes=2000).
"""

from gscl import GsclImagePlugin as GsclImagePlugin
from gscl import fields as fields
from gscl._binding import ffi as _ffi
from gscl._binding import lib as _lib
from gscl._decode import Comparison, compare, decode
from gscl._decoder import Decoder
from gscl._devices import HOST, Device, Devices, devices, release_devices
from gscl._encode import EffectDecision, Encoded, EncodedPackets, EncodeReport, Stage, TracePoint, encode
from gscl._errors import (
    AmbiguousDeviceError,
    BudgetTooSmallError,
    CancelledError,
    ConflictError,
    CorruptError,
    DamagedError,
    DeviceError,
    DeviceFailedError,
    DeviceMemoryError,
    Error,
    FieldError,
    FileError,
    GroupSizeError,
    ImageNotFiniteError,
    ImageSizeError,
    InvalidArgumentError,
    KernelBuildError,
    LimitError,
    NewerVersionError,
    NoEncoderError,
    NoPlatformError,
    NotGsclError,
    OtherPictureError,
    OutOfMemoryError,
    StructSizeError,
    TargetUnreachableError,
    TruncatedError,
    UnknownBlockError,
    UnknownDeviceError,
)
from gscl._fields import (
    BACKGROUND_WEIGHT,
    CUTOFF,
    LARGEST_ALPHA,
    SPLAT_DTYPE,
    Field,
    Packed,
    PackReport,
    make_splats,
    pack,
    read_field,
    splats,
)
from gscl._inspect import Info, certain_splats, info, metadata
from gscl._progress import Progress

__version__: str = _ffi.string(_lib.gscl_version()).decode()

__all__ = [
    "AmbiguousDeviceError",
    "BACKGROUND_WEIGHT",
    "BudgetTooSmallError",
    "CancelledError",
    "certain_splats",
    "compare",
    "Comparison",
    "ConflictError",
    "CorruptError",
    "CUTOFF",
    "DamagedError",
    "decode",
    "Decoder",
    "Device",
    "DeviceError",
    "DeviceFailedError",
    "DeviceMemoryError",
    "Devices",
    "devices",
    "EffectDecision",
    "encode",
    "Encoded",
    "EncodedPackets",
    "EncodeReport",
    "Error",
    "Field",
    "FieldError",
    "fields",
    "FileError",
    "GroupSizeError",
    "GsclImagePlugin",
    "HOST",
    "ImageNotFiniteError",
    "ImageSizeError",
    "Info",
    "info",
    "InvalidArgumentError",
    "KernelBuildError",
    "LARGEST_ALPHA",
    "LimitError",
    "make_splats",
    "metadata",
    "NewerVersionError",
    "NoEncoderError",
    "NoPlatformError",
    "NotGsclError",
    "OtherPictureError",
    "OutOfMemoryError",
    "pack",
    "Packed",
    "PackReport",
    "Progress",
    "read_field",
    "release_devices",
    "SPLAT_DTYPE",
    "splats",
    "Stage",
    "StructSizeError",
    "TargetUnreachableError",
    "TracePoint",
    "TruncatedError",
    "UnknownBlockError",
    "UnknownDeviceError",
]
