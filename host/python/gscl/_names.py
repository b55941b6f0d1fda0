"""Words for the library's enumerations."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from gscl._binding import ffi, lib
from gscl._errors import InvalidArgumentError

Preset = Literal["tiny", "preview", "small", "good"]
Tune = Literal["auto", "psnr", "ssim", "visual"]
Profile = Literal["default", "paper"]
Blend = Literal["auto", "normalized", "alpha", "sum"]
Loss = Literal["auto", "l1", "l1+ssim", "l2"]
Effect = Literal["chroma", "alpha-channel", "opacity", "rotation", "anisotropy", "codebooks", "texture"]

PRESETS = {
    "tiny": lib.GSCL_PRESET_TINY,
    "preview": lib.GSCL_PRESET_PREVIEW,
    "small": lib.GSCL_PRESET_SMALL,
    "good": lib.GSCL_PRESET_GOOD,
}
TUNES = {
    "auto": lib.GSCL_TUNE_AUTO,
    "psnr": lib.GSCL_TUNE_PSNR,
    "ssim": lib.GSCL_TUNE_SSIM,
    "visual": lib.GSCL_TUNE_VISUAL,
}
PROFILES = {"default": lib.GSCL_PROFILE_DEFAULT, "paper": lib.GSCL_PROFILE_PAPER}
BLENDS = {
    "auto": lib.GSCL_BLEND_AUTO,
    "normalized": lib.GSCL_BLEND_NORMALIZED,
    "alpha": lib.GSCL_BLEND_ALPHA,
    "sum": lib.GSCL_BLEND_SUM,
}
LOSSES = {
    "auto": lib.GSCL_LOSS_AUTO,
    "l1": lib.GSCL_LOSS_L1,
    "l1+ssim": lib.GSCL_LOSS_L1_SSIM,
    "l2": lib.GSCL_LOSS_L2,
}
BLOCKS = {"icc_profile": lib.GSCL_BLOCK_ICC, "exif": lib.GSCL_BLOCK_EXIF, "xmp": lib.GSCL_BLOCK_XMP}
SAMPLES = {"uint8": lib.GSCL_SAMPLE_U8, "uint16": lib.GSCL_SAMPLE_U16, "float32": lib.GSCL_SAMPLE_F32}
EFFECTS = {ffi.string(lib.gscl_effect_name(1 << i)).decode(): 1 << i for i in range(lib.GSCL_EFFECT_COUNT)}


def number_of(argument: str, words: dict[str, int], word: str) -> int:
    """The value of a word, which the error names as an argument."""
    if word not in words:
        raise InvalidArgumentError(f"{argument}: {word!r}: expected one of {', '.join(words)}")
    return words[word]


def word_of(words: dict[str, int], number: int) -> str:
    """The word of a value; its digits where a newer library has values that are unknown here."""
    return next((word for word, value in words.items() if value == number), str(number))


def bits_of(argument: str, names: Iterable[str]) -> int:
    if isinstance(names, str):
        names = (names,)
    return sum({number_of(argument, EFFECTS, name) for name in names})


def effects_of(bits: int) -> tuple[str, ...]:
    return tuple(name for name, bit in EFFECTS.items() if bits & bit)
