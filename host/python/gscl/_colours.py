"""What a picture says of its colours, and their conversion to sRGB, by the rules of host/PICTURES.md."""

from __future__ import annotations

import io
import warnings
from dataclasses import dataclass
from typing import IO, Any

import numpy
from numpy.typing import NDArray
from PIL import Image, ImageCms

from gscl._errors import InvalidArgumentError
from gscl._formats import boxes, file_of, find_box

# x and y of white, red, green and blue.
_SRGB = (0.3127, 0.3290, 0.640, 0.330, 0.300, 0.600, 0.150, 0.060)
_ADOBE_RGB = (0.3127, 0.3290, 0.64, 0.33, 0.21, 0.71, 0.15, 0.06)
_ADOBE_RGB_GAMMA = 563 / 256

# Primaries by the code points of ITU-T H.273.
_PRIMARIES = {
    1: _SRGB,
    2: _SRGB,  # unspecified
    4: (0.310, 0.316, 0.670, 0.330, 0.210, 0.710, 0.140, 0.080),
    5: (0.3127, 0.3290, 0.640, 0.330, 0.290, 0.600, 0.150, 0.060),
    6: (0.3127, 0.3290, 0.630, 0.340, 0.310, 0.595, 0.155, 0.070),
    7: (0.3127, 0.3290, 0.630, 0.340, 0.310, 0.595, 0.155, 0.070),
    8: (0.310, 0.316, 0.681, 0.319, 0.243, 0.692, 0.145, 0.049),
    9: (0.3127, 0.3290, 0.708, 0.292, 0.170, 0.797, 0.131, 0.046),
    10: (1 / 3, 1 / 3, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0),
    11: (0.314, 0.351, 0.680, 0.320, 0.265, 0.690, 0.150, 0.060),
    12: (0.3127, 0.3290, 0.680, 0.320, 0.265, 0.690, 0.150, 0.060),
    22: (0.3127, 0.3290, 0.630, 0.340, 0.295, 0.605, 0.155, 0.077),
}
# Exponents from samples to light; 0 is the curve of sRGB, as which browsers take those of television, too.
_GAMMAS = {1: 0.0, 2: 0.0, 6: 0.0, 13: 0.0, 14: 0.0, 15: 0.0, 4: 2.2, 5: 2.8, 8: 1.0}
_HDR = {16: "PQ", 18: "HLG"}

_PNG_GAMMA_OF_SRGB = 0.45455  # 1 / 2.2, by which encoders approximate the curve of sRGB
_SAME_AS_SRGB = 2  # of 255: profiles that change no colour by more are taken as sRGB
_BLOCK = 1 << 20  # samples that are converted at once

_BRADFORD = numpy.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])
_D50 = (0.3457, 0.3585)


@dataclass(frozen=True)
class Colours:
    """The colours of a picture: the first of code points, profile, and primaries with a gamma; all None for sRGB."""

    cicp: tuple[int, int] | None = None
    profile: bytes | None = None
    primaries: tuple[float, ...] | None = None
    gamma: float = 0.0
    """Exponent from samples to light; 0 for the curve of sRGB."""


def colours_of(image: Image.Image, names_adobe_rgb: bool) -> Colours:
    """What an image says: in its file, as far as that is at hand, and in what Pillow read of it.

    names_adobe_rgb: whether its EXIF says that the colours are those of Adobe RGB.
    """
    info = image.info
    cicp, profile = info.get("cicp") or _cicp_in_file(image), info.get("icc_profile")
    if image.format != "PNG" and profile:
        cicp = None  # in HEIF a profile precedes code points
    if cicp:
        return Colours(cicp=(cicp[0], cicp[1]))
    if profile:
        return Colours(profile=profile)
    if "srgb" in info:
        return Colours()
    gamma, primaries = info.get("gamma"), info.get("chromaticity")
    if gamma and abs(gamma - _PNG_GAMMA_OF_SRGB) < 1e-6:
        gamma = None
    if gamma or primaries:
        return Colours(primaries=primaries or _SRGB, gamma=1 / gamma if gamma else 0.0)
    return Colours(primaries=_ADOBE_RGB, gamma=_ADOBE_RGB_GAMMA) if names_adobe_rgb else Colours()


def require_conversion(colours: Colours) -> None:
    """Refuses colours that exceed the range of a display."""
    if colours.cicp and colours.cicp[1] in _HDR:
        raise InvalidArgumentError(
            f"a picture with HDR colours ({_HDR[colours.cicp[1]]}), which cannot be converted to sRGB; "
            f"cicp={colours.cicp} stores them unchanged"
        )


def can_be_stored(colours: Colours, samples: NDArray[Any]) -> bool:
    """Whether a file can say that samples have these colours.  It holds no profile of RGB for grey."""
    if colours.cicp:
        return True
    if not colours.profile:
        return False
    try:
        space = ImageCms.ImageCmsProfile(io.BytesIO(colours.profile)).profile.xcolor_space.strip()
    except (ImageCms.PyCMSError, OSError, ValueError):
        return False
    return bool(space == ("GRAY" if samples.ndim == 2 or samples.shape[2] == 2 else "RGB"))


# ---- Code points in files ----------------------------------------------------------------------------


def _cicp_in_file(image: Image.Image) -> tuple[int, int] | None:
    """The code points of a PNG or HEIF file, which Pillow does not read."""
    reader = {"PNG": _cicp_in_png, "AVIF": _cicp_in_heif, "HEIF": _cicp_in_heif}.get(image.format or "")
    with file_of(image) as file:
        return reader(file) if reader and file else None


def _cicp_in_png(file: IO[bytes]) -> tuple[int, int] | None:
    file.seek(8)
    while len(head := file.read(8)) == 8 and head[4:] not in (b"IDAT", b"IEND"):
        size = int.from_bytes(head[:4], "big")
        if head[4:] == b"cICP":
            data = file.read(min(size, 4))
            return (data[0], data[1]) if size == 4 and data[2:] == b"\0\1" else None
        file.seek(size + 4, io.SEEK_CUR)
    return None


def _cicp_in_heif(file: IO[bytes]) -> tuple[int, int] | None:
    meta = find_box(file.read(), b"meta")[4:]
    for kind, content in boxes(find_box(find_box(meta, b"iprp"), b"ipco")):
        if kind == b"colr" and content[:4] == b"nclx" and len(content) >= 8 and content[4] == content[6] == 0:
            return content[5], content[7]
    return None


# ---- Conversion ----------------------------------------------------------------------------------


def to_srgb(samples: NDArray[Any], colours: Colours) -> NDArray[Any]:
    """Converts the colours of samples of shape (height, width) or (height, width, channels); alpha stays."""
    if colours.profile:
        return _by_profile(samples, colours.profile)
    primaries, gamma = colours.primaries, colours.gamma
    if colours.cicp:
        if colours.cicp[0] not in _PRIMARIES or colours.cicp[1] not in _GAMMAS:
            _warn("the code points of the picture are unknown; its colours are taken as sRGB")
            return samples
        primaries, gamma = _PRIMARIES[colours.cicp[0]], _GAMMAS[colours.cicp[1]]
    if primaries is None:
        return samples
    try:
        matrix = numpy.linalg.solve(_to_xyz(_SRGB), _to_xyz(primaries))
    except numpy.linalg.LinAlgError:
        _warn("the primaries of the picture span no triangle; its colours are taken as sRGB")
        return samples
    if gamma == 0 and numpy.abs(matrix - numpy.eye(3)).max() < 0.01:
        return samples
    return _by_matrix(samples, matrix, gamma)


def _warn(text: str) -> None:
    warnings.warn(text, stacklevel=7)


def _to_xyz(xy: tuple[float, ...]) -> NDArray[Any]:
    """From linear RGB to XYZ, for a white of D50."""
    columns = numpy.array([(x, y, 1 - x - y) for x, y in zip(xy[2::2], xy[3::2])]).T
    white, d50 = (numpy.array((x / y, 1, (1 - x - y) / y)) for x, y in (xy[:2], _D50))
    adapted = numpy.linalg.solve(_BRADFORD, numpy.diag(_BRADFORD @ d50 / (_BRADFORD @ white)) @ _BRADFORD)
    scaled: NDArray[Any] = adapted @ (columns * numpy.linalg.solve(columns, white))
    return scaled


def _light(samples: NDArray[Any], gamma: float) -> NDArray[Any]:
    if gamma:
        power: NDArray[Any] = numpy.power(numpy.maximum(samples, 0), gamma)
        return power
    light: NDArray[Any] = ((numpy.maximum(samples, 0) + 0.055) / 1.055) ** 2.4
    return numpy.where(samples <= 0.04045, samples / 12.92, light)


def _curve(light: NDArray[Any]) -> NDArray[Any]:
    light = numpy.maximum(light, 0)
    return numpy.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def _by_matrix(samples: NDArray[Any], matrix: NDArray[Any], gamma: float) -> NDArray[Any]:
    planes = samples[..., None] if samples.ndim == 2 else samples
    colours = 1 if planes.shape[2] <= 2 else 3
    peak = 1.0 if samples.dtype.kind == "f" else float(numpy.iinfo(samples.dtype).max)
    result = planes.copy()
    rows = max(1, _BLOCK // (planes.shape[1] * colours))
    for y in range(0, planes.shape[0], rows):
        light = _light(planes[y : y + rows, :, :colours] / peak, gamma)
        converted = _curve(light @ matrix.T if colours == 3 else light)
        if samples.dtype.kind != "f":
            converted = numpy.rint(converted.clip(0, 1) * peak)
        result[y : y + rows, :, :colours] = converted
    return result.reshape(samples.shape)


def _by_profile(samples: NDArray[Any], profile: bytes) -> NDArray[Any]:
    """LittleCMS, as Pillow has it, converts 8 bits; grey of other depths goes through its curve of 256 greys."""
    channels = 1 if samples.ndim == 2 else samples.shape[2]
    try:
        transform = _Transform(profile, "L" if channels <= 2 else "RGB")
    except (ImageCms.PyCMSError, OSError, ValueError) as error:
        _warn(f"the colour profile cannot be used, colours are taken as sRGB: {error}")
        return samples
    if transform.is_identity:
        return samples
    if samples.dtype == numpy.uint8:
        return transform.convert(samples)
    peak = 1.0 if samples.dtype.kind == "f" else float(numpy.iinfo(samples.dtype).max)
    curve = transform.convert(numpy.arange(256, dtype=numpy.uint8)[None])[0] / 255
    grey = samples[..., :1] if samples.ndim == 3 else samples
    converted = numpy.interp(grey / peak, numpy.arange(256) / 255, curve) * peak
    result = samples.copy()
    result[..., : grey.shape[-1]] = converted if samples.dtype.kind == "f" else numpy.rint(converted)
    return result


class _Transform:
    """From a profile to sRGB, for pixels of 8 bits: "L" or "RGB", with or without alpha."""

    def __init__(self, profile: bytes, mode: str) -> None:
        opened = ImageCms.ImageCmsProfile(io.BytesIO(profile))
        # Grey pixels may have a profile of RGB: then all three samples are that grey.
        self.mode = "RGB" if opened.profile.xcolor_space.strip() == "RGB" else mode
        self.transform = ImageCms.buildTransform(
            opened,
            ImageCms.createProfile("sRGB"),
            self.mode,
            "RGB",
            ImageCms.Intent.RELATIVE_COLORIMETRIC,
            ImageCms.Flags.BLACKPOINTCOMPENSATION,
        )
        steps = numpy.linspace(0, 255, 9).astype(numpy.uint8)
        probe = numpy.stack(numpy.meshgrid(steps, steps, steps), -1).reshape(1, -1, 3)
        greys = numpy.arange(256, dtype=numpy.uint8)[None, :, None].repeat(3, 2)
        probe = numpy.concatenate([greys, probe], 1) if mode == "RGB" else greys[..., 0]
        self.is_identity = int(numpy.abs(self.convert(probe) - probe.astype(int)).max()) <= _SAME_AS_SRGB

    def convert(self, samples: NDArray[Any]) -> NDArray[Any]:
        channels = 1 if samples.ndim == 2 else samples.shape[2]
        colours = samples if channels in (1, 3) else samples[..., :-1]
        image = Image.fromarray(numpy.ascontiguousarray(colours).squeeze(-1) if colours.shape[-1:] == (1,) else colours)
        applied = ImageCms.applyTransform(image.convert(self.mode), self.transform)
        assert applied is not None
        converted = numpy.asarray(applied)
        if channels <= 2:
            converted = converted[..., 0] if samples.ndim == 2 else converted[..., :1]
        return converted if channels in (1, 3) else numpy.concatenate([converted, samples[..., -1:]], -1)


def inks_to_srgb(image: Image.Image, colours: Colours) -> NDArray[Any]:
    """The RGB samples of a CMYK image, which needs a profile."""
    if not colours.profile:
        raise InvalidArgumentError("a picture of CMYK colours without a colour profile; convert it to RGB first")
    try:
        converted = ImageCms.profileToProfile(
            image,
            ImageCms.ImageCmsProfile(io.BytesIO(colours.profile)),
            ImageCms.createProfile("sRGB"),
            renderingIntent=ImageCms.Intent.RELATIVE_COLORIMETRIC,
            outputMode="RGB",
            flags=ImageCms.Flags.BLACKPOINTCOMPENSATION,
        )
    except (ImageCms.PyCMSError, OSError, ValueError) as error:
        raise InvalidArgumentError(
            f"a picture of CMYK colours and a colour profile that is damaged or not for CMYK ({error}); "
            "convert it to RGB first"
        ) from None
    assert converted is not None
    return numpy.asarray(converted)
