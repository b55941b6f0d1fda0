"""python -m gscl: encodes, decodes and inspects files with this package alone; a part of what the program gscl does."""

from __future__ import annotations

import argparse
import dataclasses
import errno
import io
import json
import math
import os
import sys
import tempfile
import warnings
from typing import BinaryIO

from PIL import Image

import gscl
from gscl._arguments import add_targets, numbers
from gscl._colours import Colours, require_conversion, to_srgb
from gscl._inspect import readable_metadata

_EPILOG = """
- in place of a file is standard input or output.  A file is written whole or not at all.  Options are those of the program
gscl, which has more of them, and more commands; it is built from the same sources.

status: 0 success, 1 failure, 2 wrong command line, 130 after Ctrl-C
"""

# Limits of the program gscl on what files of strangers can cost.
_MAX_PIXELS, _MAX_WORK = 10**8, 10**11


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m gscl", description=__doc__, epilog=_EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--version", action="version", version=f"gscl {gscl.__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    _add_encode(commands.add_parser("encode", help="encode a picture that Pillow reads", allow_abbrev=False))
    _add_decode(commands.add_parser("decode", help="decode a file to a picture that Pillow writes", allow_abbrev=False))
    information = commands.add_parser("info", help="check a file, and show what it says about itself", allow_abbrev=False)
    information.add_argument("input", metavar="IN")
    information.add_argument("--bare", action="store_true", help="the file was made with --bare")
    information.add_argument("--json", action="store_true", help="write the fields of gscl.info as JSON")
    information.set_defaults(run=_info)
    commands.add_parser("devices", help="list the devices that encode").set_defaults(run=_devices)
    return parser


def _add_encode(parser: argparse.ArgumentParser) -> None:
    _add_places(parser, "OUT.gscl")
    add_targets(parser)
    parser.add_argument("--effort", metavar="N", type=int, help="0 is fastest, 9 has the best quality (default 5, or that of the preset)")
    parser.add_argument("--tune", choices=["auto", "psnr", "ssim", "visual"], default="auto", help="quality measure to optimise")
    parser.add_argument("--seed", metavar="S", type=int, default=1, help="of the random numbers (default 1)")
    parser.add_argument("--progressive", action="store_true", help="write layers")
    parser.add_argument("--bare", action="store_true", help="write the picture alone; readers must be told")
    parser.add_argument("--quiet", action="store_true", help="print errors only")
    parser.set_defaults(run=_encode)


def _add_decode(parser: argparse.ArgumentParser) -> None:
    _add_places(parser, "OUT.png")
    parser.add_argument("--size", metavar="WxH", type=numbers("WxH", "x"), help="draw at this size (default: as encoded)")
    parser.add_argument("--crop", metavar="X,Y,W,H", type=numbers("X,Y,W,H", ","), help="write only this part of the drawn image")
    parser.add_argument("--partial", action="store_true", help="draw what has come of a file that is cut off")
    parser.add_argument("--bare", action="store_true", help="the file was made with --bare")
    parser.add_argument("--max-pixels", metavar="N", type=int, default=_MAX_PIXELS, help="refuse to draw more (default %(default)s)")
    parser.add_argument("--max-work", metavar="N", type=int, default=_MAX_WORK, help="refuse a file that needs more (default %(default)s)")
    parser.set_defaults(run=_decode)


def _add_places(parser: argparse.ArgumentParser, output: str) -> None:
    parser.add_argument("input", metavar="IN")
    parser.add_argument("-o", "--output", metavar=output, required=True)
    parser.add_argument("--device", metavar="D", help='of "python -m gscl devices"')
    parser.add_argument("--threads", metavar="N", type=int, default=0, help="of the device host (default: all that there are)")


# ---- Commands ------------------------------------------------------------------------------------


def _encode(options: argparse.Namespace) -> None:
    _require_folder(options.output)
    names = "preset", "bytes", "bpp", "psnr", "ssimulacra2", "quality", "splats", "effort", "tune", "seed", "progressive", "bare", "device", "threads"
    encoded = gscl.encode(_opened(options.input), **{name: getattr(options, name) for name in names})
    _write(options.output, encoded)
    if not options.quiet:
        report = encoded.report
        quality = f"{report.psnr:.2f} dB" + ("" if math.isnan(report.ssimulacra2) else f", SSIMULACRA 2 {report.ssimulacra2:.2f}")
        print(f"{options.output}: {report.bytes} bytes, {report.splats} splats, {quality}, {report.seconds:.2f} s", file=sys.stderr)


def _decode(options: argparse.Namespace) -> None:
    extension = os.path.splitext(options.output)[1].lower()
    kind = "PNG" if options.output == "-" else Image.registered_extensions().get(extension)
    if kind is None:
        raise gscl.InvalidArgumentError(f"{options.output}: Pillow writes no pictures with the suffix {extension!r}; .png would do")
    _require_folder(options.output)
    data = _read(options.input)
    header = gscl.info(data, bare=options.bare, header_only=True)
    samples = gscl.decode(
        data,
        size=options.size,
        crop=options.crop,
        dtype=header.dtype if header.channels == 1 else "uint8",  # Pillow has no colours of 16 bits
        partial=options.partial,
        bare=options.bare,
        max_pixels=options.max_pixels,
        max_work=options.max_work,
        device=options.device,
        threads=options.threads,
    )
    blocks = {} if options.bare else readable_metadata(data)
    if "cicp" in blocks:
        colours = Colours(cicp=blocks.pop("cicp"))
        require_conversion(colours)
        samples = to_srgb(samples, colours)
    if "exif" in blocks:
        blocks["exif"] = b"Exif\0\0" + blocks["exif"]
    memory = io.BytesIO()
    Image.fromarray(samples).save(memory, kind, **blocks)
    _write(options.output, memory.getvalue())


def _info(options: argparse.Namespace) -> None:
    info = gscl.info(_read(options.input), bare=options.bare)
    if options.json:
        print(json.dumps(dataclasses.asdict(info)))
        return
    kind = {1: "grey", 2: "grey and alpha", 3: "RGB", 4: "RGBA"}[info.channels]
    print(f"{options.input}: {info.width} x {info.height} {kind}, {info.dtype}, format version {info.format_version}")
    print(f"{info.splats} splats, {info.bytes} bytes, {8 * info.bytes / info.pixels:.4f} bits per pixel")
    print(f"profile {info.profile}, blend {info.blend}, effects: {', '.join(info.effects) or 'none'}")


def _devices(options: argparse.Namespace) -> None:
    print(gscl.devices())


# ---- Files ---------------------------------------------------------------------------------------


def _opened(name: str) -> str | BinaryIO:
    return sys.stdin.buffer if name == "-" else name


def _read(name: str) -> bytes:
    if name == "-":
        return sys.stdin.buffer.read()
    with open(name, "rb") as file:
        return file.read()


def _require_folder(name: str) -> None:
    """Before the work, which may take minutes."""
    folder = os.path.dirname(os.path.realpath(name))
    if name != "-" and not os.path.isdir(folder):
        raise FileNotFoundError(errno.ENOENT, "the folder of this output does not exist", name)


def _is_special(name: str) -> bool:
    return os.path.exists(name) and not os.path.isfile(name)


def _write(name: str, data: bytes) -> None:
    """Writes a file whole or not at all; pipes and devices in place."""
    if name == "-":
        sys.stdout.buffer.write(data)
        sys.stdout.buffer.flush()
        return
    if _is_special(name):
        with open(name, "wb") as file:
            file.write(data)
        return
    path = os.path.realpath(name)
    with tempfile.TemporaryDirectory(prefix=".gscl-", dir=os.path.dirname(path)) as folder:
        unfinished = os.path.join(folder, "unfinished")
        with open(unfinished, "xb") as file:
            file.write(data)
        os.replace(unfinished, path)


def _line(error: object) -> str:
    if isinstance(error, OSError) and error.filename:
        error = f"{error.filename}: {error.strerror}"
    return f"gscl: {error}\n"


def main(arguments: list[str] | None = None) -> int:
    options = _parser().parse_args(arguments)
    try:
        options.run(options)
        sys.stdout.flush()
    except KeyboardInterrupt:
        return 130
    except gscl.FileError as error:
        sys.stderr.write(_line(f"{options.input}: {error}"))
        return 1
    except (gscl.Error, OSError, Image.DecompressionBombError) as error:
        sys.stderr.write(_line(error))
        return 1
    return 0


if __name__ == "__main__":
    warnings.formatwarning = lambda message, *others, **named: _line(message)
    sys.exit(main())
