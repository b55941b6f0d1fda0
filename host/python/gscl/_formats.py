"""Files whose pixels Pillow gives as they say; others are refused.  tests/formats compares them with other readers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import IO, Any

from PIL import Image

from gscl._errors import InvalidArgumentError

# By their names in Pillow.  Images of other formats can be passed as copies, which have no format.
_FORMATS = ("AVIF", "BMP", "GIF", "GSCL", "HEIF", "ICO", "JPEG", "JPEG2000", "MPO", "PNG", "PPM", "TIFF", "WEBP")

# Tags of TIFF.
_BITS, _COLOUR_MAP, _PLANES, _SAMPLE_FORMAT = 258, 320, 284, 339
_SIGNED = 2

_HEAD = 1 << 16  # bytes of a file that hold its header


@contextmanager
def file_of(image: Image.Image) -> Iterator[IO[bytes] | None]:
    """The file that an image was opened from, at its start; None where it is not at hand."""
    file, name = getattr(image, "fp", None), getattr(image, "filename", "")
    if file is not None and not file.closed and file.seekable():
        place = file.tell()
        try:
            file.seek(0)
            yield file
        finally:
            file.seek(place)
        return
    try:
        opened = open(name, "rb") if name else None
    except OSError:
        opened = None
    try:
        yield opened
    finally:
        if opened:
            opened.close()


def boxes(data: bytes) -> Iterator[tuple[bytes, bytes]]:
    """The boxes of an ISO file, or in one: kinds and contents.  The last may be cut off."""
    while len(data) >= 8:
        size, start = int.from_bytes(data[:4], "big"), 8
        if size == 1:
            size, start = int.from_bytes(data[8:16], "big"), 16
        size = size or len(data)
        if size < start:
            return
        yield data[4:8], data[start:size]
        data = data[size:]


def find_box(data: bytes, kind: bytes) -> bytes:
    return next((content for found, content in boxes(data) if found == kind), b"")


def checked(image: Image.Image) -> Image.Image:
    """An image whose pixels are what its file says; refuses those that are not and cannot be corrected."""
    if image.format is None:  # made by a program
        return image
    if image.format not in _FORMATS:
        raise InvalidArgumentError(
            f"a picture of the format {image.format}, which is not read; convert it to PNG first, or pass image.copy() "
            "if its pixels are right"
        )
    with file_of(image) as file:
        head = file.read(_HEAD) if file else b""
    find_reason = _CHECKS.get(image.format)
    if find_reason and (reason := find_reason(image, head)):
        raise InvalidArgumentError(f"a {image.format} picture {reason}, which is not read; convert it to PNG first")
    return _corrected_png(image, head) if image.format == "PNG" else image


def _corrected_png(image: Image.Image, head: bytes) -> Image.Image:
    """Pillow gives grey and alpha of 16 bits as RGBA, and does not scale a transparent grey of 2 or 4 bits."""
    depth, kind = head[24:25], head[25:26]
    if kind == b"\4" and image.mode == "RGBA":
        grey = Image.merge("LA", (image.getchannel("R"), image.getchannel("A")))
        grey.info = dict(image.info)
        grey.format = image.format
        return grey
    clear = image.info.get("transparency")
    if kind == b"\0" and depth in (b"\2", b"\4") and isinstance(clear, int):
        image = image.copy()
        image.format = "PNG"
        image.info["transparency"] = clear * 255 // (2 ** depth[0] - 1)
    return image


def _check_png(image: Image.Image, head: bytes) -> str | None:
    transparent = "transparency" in image.info
    if transparent and image.mode == "RGB" and head[24:25] == b"\x10":
        return "of 16 bits with a transparent colour"
    return None


def _check_gif(image: Image.Image, head: bytes) -> str | None:
    extent: Any = getattr(image, "dispose_extent", None)
    return "whose first frame is smaller than it" if extent and tuple(extent) != (0, 0, *image.size) else None


def _check_bmp(image: Image.Image, head: bytes) -> str | None:
    number = [int.from_bytes(head[at : at + 4], "little") for at in (14, 30, 66)]
    bits = int.from_bytes(head[28:30], "little")
    return "of 16 bits with alpha" if number[0] >= 56 and number[1] == 3 and bits == 16 and number[2] else None


def _check_ico(image: Image.Image, head: bytes) -> str | None:
    return "whose alpha is 0 everywhere" if image.mode == "RGBA" and image.getchannel("A").getbbox() is None else None


def _check_jpeg2000(image: Image.Image, head: bytes) -> str | None:
    header = find_box(head, b"jp2h")
    at = head.find(b"\xff\x4f\xff\x51")  # the code stream; the first component follows 42 bytes of it
    depth = (head[at + 42] & 127) + 1 if 0 <= at < len(head) - 42 else 8
    if depth > 8 and not image.mode.startswith("I"):
        return "of more than 8 bits in colour"
    definitions = find_box(header, b"cdef")
    kinds = [int.from_bytes(definitions[at + 2 : at + 4], "big") for at in range(2, len(definitions), 6)]
    return "with alpha of another kind than straight" if any(kind > 1 for kind in kinds) else None


def _check_tiff(image: Image.Image, head: bytes) -> str | None:
    tags: Any = getattr(image, "tag_v2", {})
    bits, planes = tags.get(_BITS, (1,)), tags.get(_PLANES, 1)
    if bits[0] not in (1, 2, 4, 8, 16, 32):
        return f"of {bits[0]} bits"
    if planes == 2 and bits[0] > 8:
        return f"of planes of {bits[0]} bits"
    if _SIGNED in tags.get(_SAMPLE_FORMAT, ()):
        return "of negative samples"
    if max(tags.get(_COLOUR_MAP, (256,))) < 256:
        return "with a palette of 8 bits"
    return None


_CHECKS: dict[str, Callable[[Image.Image, bytes], str | None]] = {
    "PNG": _check_png,
    "GIF": _check_gif,
    "BMP": _check_bmp,
    "ICO": _check_ico,
    "JPEG2000": _check_jpeg2000,
    "TIFF": _check_tiff,
}
