"""Options that the commands of this package share."""

from __future__ import annotations

import argparse
from collections.abc import Callable


def add_targets(parser: argparse.ArgumentParser | argparse._ArgumentGroup) -> None:
    """The targets of gscl.encode, of which at most one may be given."""
    target = parser.add_mutually_exclusive_group()
    target.add_argument("--preset", choices=["tiny", "preview", "small", "good"], help="target and effort by what the file is for")
    target.add_argument("-q", "--quality", metavar="Q", type=float, help="quality as of JPEG, 0 to 100")
    target.add_argument("--bytes", metavar="N", type=int, help="the most bytes of a file")
    target.add_argument("--bpp", metavar="R", type=float, help="the most bits per pixel (default: 0.125, at least 256 bytes)")
    target.add_argument("--psnr", metavar="DB", type=float, help="PSNR to reach in dB")
    target.add_argument("--ssimulacra2", metavar="X", type=float, help="SSIMULACRA 2 to reach")
    target.add_argument("--splats", metavar="N", type=int, help="number of splats")


def numbers(form: str, separator: str) -> Callable[[str], tuple[int, ...]]:
    """A type of options that are whole numbers in this form, which the error names."""

    def parse(text: str) -> tuple[int, ...]:
        parts = text.split(separator)
        if len(parts) != len(form.split(separator)) or not all(part.isdecimal() for part in parts):
            raise argparse.ArgumentTypeError(f"{text!r}: expected {form}")
        return tuple(int(part) for part in parts)

    return parse
