"""EXIF and XMP of pictures, and how their pixels lie, by the rules of host/PICTURES.md."""

from __future__ import annotations

import re
from typing import Any

from PIL import Image

from gscl._colours import Colours

_ORIENTATION, _EXIF, _COLOUR_SPACE, _INTEROPERABILITY, _INDEX = 0x0112, 0x8769, 0xA001, 0xA005, 0x0001
_SRGB, _ADOBE_RGB = 1, 2  # values of the colour space; the second is not of the standard

_TURNS = {
    2: Image.Transpose.FLIP_LEFT_RIGHT,
    3: Image.Transpose.ROTATE_180,
    4: Image.Transpose.FLIP_TOP_BOTTOM,
    5: Image.Transpose.TRANSPOSE,
    6: Image.Transpose.ROTATE_270,
    7: Image.Transpose.TRANSVERSE,
    8: Image.Transpose.ROTATE_90,
}


class Metadata:
    """What a picture has beside its pixels.  Its blocks describe the upright picture."""

    def __init__(self, exif: Image.Exif, xmp: bytes | None) -> None:
        self.exif, self.xmp = exif, xmp
        orientation = exif.get(_ORIENTATION, 1)
        self.orientation = orientation if orientation in _TURNS else 1
        space = exif.get_ifd(_EXIF).get(_COLOUR_SPACE)
        index = exif.get_ifd(_INTEROPERABILITY).get(_INDEX, "")
        self.names_adobe_rgb = space == _ADOBE_RGB or (space != _SRGB and str(index).startswith("R03"))

    def set_srgb(self) -> None:
        """States that the colours are those of sRGB, where the block says otherwise."""
        if self.names_adobe_rgb:
            self.exif.get_ifd(_EXIF)[_COLOUR_SPACE] = _SRGB
            if _INDEX in (interoperability := self.exif.get_ifd(_INTEROPERABILITY)):
                interoperability[_INDEX] = "R98"

    def blocks(self, colours: Colours) -> dict[str, Any]:
        """All that can be stored: "icc_profile", "cicp", "exif" and "xmp"."""
        if _ORIENTATION in self.exif:
            self.exif[_ORIENTATION] = 1
        found = {
            "icc_profile": colours.profile,
            "cicp": colours.cicp,
            "exif": self.exif.tobytes().removeprefix(b"Exif\0\0") if len(self.exif) else None,
            "xmp": self.xmp and re.sub(rb'(tiff:Orientation(?:="|>))[2-8]', rb"\g<1>1", self.xmp),
        }
        return {name: data for name, data in found.items() if data}


def read_metadata(image: Image.Image) -> Metadata:
    """What Pillow read of a file.  Whatever XMP says of the orientation does not count, unlike in Pillow."""
    xmp = image.info.get("xmp") or image.info.get("XML:com.adobe.xmp")
    xmp = xmp.encode() if isinstance(xmp, str) else xmp
    return Metadata(_exif_of(image), xmp)


def _exif_of(image: Image.Image) -> Image.Exif:
    data = image.info.get("exif") or _raw_profile(image.info)
    if data is None and getattr(image, "tag_v2", None) is not None:
        return _exif_of_tiff(image)
    exif = Image.Exif()
    if data:
        try:
            exif.load(data)
        except (SyntaxError, ValueError, OSError):  # damaged: as if there was none
            exif = Image.Exif()
    return exif


def _exif_of_tiff(image: Image.Image) -> Image.Exif:
    """Loads the pixels, which Pillow turns upright as the tag of TIFF says, but not as XMP does."""
    kept: dict[str | tuple[int, int], Any] = {name: image.info.pop(name) for name in ("xmp", "XML:com.adobe.xmp") if name in image.info}
    try:
        image.load()
        return image.getexif()
    finally:
        image.info.update(kept)


def _raw_profile(info: dict[Any, Any]) -> bytes | None:
    """EXIF in a text of PNG, as ImageMagick and others wrote it: a name, a length, and digits."""
    for name in ("Raw profile type exif", "Raw profile type APP1"):
        lines = str(info.get(name, "")).split("\n")
        try:
            data = bytes.fromhex("".join(lines[3:]))
        except ValueError:
            continue
        if data.startswith(b"Exif\0\0") or data[:4] in (b"II*\0", b"MM\0*"):
            return data
    return None


def turned_upright(image: Image.Image, orientation: int) -> Image.Image:
    return image.transpose(_TURNS[orientation]) if orientation in _TURNS else image
