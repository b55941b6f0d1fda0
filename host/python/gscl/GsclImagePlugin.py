"""Plugin for Pillow: Image.open, Image.save and Image.draft for gscl files.  `import gscl` registers it."""

from __future__ import annotations

import io
import math
import warnings
from collections.abc import Iterable
from typing import IO, Any

from PIL import Image, ImageFile, UnidentifiedImageError

from gscl._decode import decode
from gscl._encode import encode
from gscl._errors import FileError, LimitError, NotGsclError
from gscl._inspect import info, readable_metadata

MAX_WORK: int | None = 2 * 10**10
"""Largest number of evaluations of a splat at a pixel for a picture; None for no limit.  A core does about 5e8 a second.
Beside Image.MAX_IMAGE_PIXELS it protects from files of strangers: load raises Image.DecompressionBombError."""

MAGIC = b"\xc7gsc", b"\xc7gsp"  # of a file, and of a list of packets

# A tuple in Pillow 10, with names later.
_tile: Any = getattr(ImageFile, "_Tile", lambda *fields: fields)

_MODES = {1: "L", 2: "LA", 3: "RGB", 4: "RGBA"}

# Options of Image.save: the arguments of gscl.encode.
_OPTIONS = tuple(sorted(encode.__kwdefaults__ or ()))


def _accept(prefix: bytes) -> bool:
    return prefix.startswith(MAGIC)


class GsclImageFile(ImageFile.ImageFile):
    format = "GSCL"
    format_description = "gscl, an image as 2D Gaussians"

    _data: bytes | None = None  # the file until the picture is drawn

    def _open(self) -> None:
        assert self.fp is not None
        self._data = self.fp.read()
        try:
            header = info(self._data, header_only=True)
            blocks = readable_metadata(self._data)  # load reports damage
        except NotGsclError as error:
            raise SyntaxError(str(error)) from error
        except FileError as error:
            raise UnidentifiedImageError(str(error)) from error
        self._size = header.width, header.height
        self._mode = "I;16" if header.dtype == "uint16" and header.channels == 1 else _MODES[header.channels]
        for name in ("icc_profile", "exif", "xmp"):
            if name in blocks:
                self.info[name] = blocks[name]
        self.tile = []

    def draft(self, mode: str | None, size: tuple[int, int] | None) -> tuple[str, tuple[int, int, float, float]] | None:
        """Draws the picture at the smallest size that covers `size`, if that is below the encoded one."""
        if self._data is None or size is None:
            return None
        scale = min(1.0, max(size[0] / self.width, size[1] / self.height))
        self._size = max(1, math.ceil(self.width * scale)), max(1, math.ceil(self.height * scale))
        return self.mode, (0, 0, *self.size)

    def load(self) -> Any:
        if self._data is not None:
            dtype = "uint16" if self.mode == "I;16" else "uint8"
            partial = ImageFile.LOAD_TRUNCATED_IMAGES
            try:
                samples = decode(self._data, size=self.size, dtype=dtype, partial=partial, max_work=MAX_WORK)
            except LimitError as error:
                raise Image.DecompressionBombError(f"{error}; the limit is GsclImagePlugin.MAX_WORK") from error
            except FileError as error:
                raise OSError(str(error)) from error
            self._data = None
            if self.fp and self._exclusive_fp:
                self.fp.close()
            self.fp = io.BytesIO(samples.tobytes())
            self.tile = [_tile("raw", (0, 0, *self.size), 0, self.mode)]
        return super().load()

    def load_seek(self, pos: int) -> None:
        pass

    def verify(self) -> None:
        """Reads and checks the whole file without drawing it."""
        if self._data is not None:
            try:
                info(self._data)
            except FileError as error:
                raise OSError(str(error)) from error
        super().verify()


def _save(im: Image.Image, fp: IO[bytes], filename: str | bytes) -> None:
    arguments = {name: value for name, value in im.encoderinfo.items() if name in _OPTIONS}
    _warn_of_unknown(name for name in im.encoderinfo if name not in _OPTIONS)
    if isinstance(arguments.get("exif"), Image.Exif):
        arguments["exif"] = arguments["exif"].tobytes()
    fp.write(encode(im, **arguments))


def _warn_of_unknown(names: Iterable[str]) -> None:
    """In the line that calls Image.save."""
    for name in names:
        text = f"{name!r} is not an option of gscl files, and has no effect; those are {', '.join(_OPTIONS)}"
        warnings.warn(text, stacklevel=4)


Image.register_open(GsclImageFile.format, GsclImageFile, _accept)
Image.register_save(GsclImageFile.format, _save)
Image.register_extensions(GsclImageFile.format, [".gscl", ".gsclp"])
Image.register_mime(GsclImageFile.format, "image/x-gscl")
