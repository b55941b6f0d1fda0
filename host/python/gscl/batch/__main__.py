"""python -m gscl.batch: encodes many pictures, or packs or unpacks many fields, on the machines of a Dask cluster."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from typing import Any, NamedTuple, NoReturn, get_args

import distributed

from gscl._arguments import add_targets, numbers
from gscl._errors import Error
from gscl.batch import BatchProgress, Summary, pack, run, unpack
from gscl.batch._conversions import LoaderName

_EPILOG = """
status: 0 if all files are done; 1 if some failed, or the run could not go on; 2 for a wrong command line; 130
after Ctrl-C.  The same command completes a run that ended early: what is done is not done again, what failed is tried
again.

examples:
  python -m gscl.batch 'photos/**/*.jpg' --out gscl --report report --bpp 0.1
  python -m gscl.batch s3://bucket/names.txt.gz --root s3://bucket/photos --out s3://bucket/gscl \\
      --report s3://bucket/report --scheduler tcp://10.0.0.1:8786
  python -m gscl.batch --pack 'fields/**/*.npz' --out gscl --report report-of-packing --psnr 32
  python -m gscl.batch --pack 'models/*/gaussian_model.pth.tar' --loader gaussianimage --size 768x512 \\
      --out gscl --report report-of-packing
  python -m gscl.batch --unpack 'gscl/**/*.gscl' --out fields --report report-of-unpacking
  python -c 'import gscl.batch; print(gscl.batch.read_report("report").to_pandas())'
"""


def _shard(text: str) -> tuple[int, int]:
    index, count = (int(part) for part in text.split("/"))
    if not 1 <= index <= count:
        raise ValueError
    return index, count


def _colour(text: str) -> tuple[float, ...]:
    return tuple(float(part) for part in text.split(","))


def _count(text: str) -> int:
    if int(text) < 1:
        raise ValueError
    return int(text)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m gscl.batch",
        description="Encodes many pictures, or packs or unpacks many fields, on the machines of a Dask cluster, or on this "
        "machine, and reports on each.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "files",
        metavar="FILES",
        help="a glob, in quotes, or the name of a text file with a name in each line; paths or URLs of fsspec",
    )
    kinds = parser.add_mutually_exclusive_group()
    kinds.add_argument(
        "--pack",
        action="store_const",
        const="pack",
        default="encode",
        dest="kind",
        help="FILES are fields of Gaussians: write them as gscl files",
    )
    kinds.add_argument(
        "--unpack",
        action="store_const",
        const="unpack",
        dest="kind",
        help="FILES are gscl files: write their fields as NPZ, without loss",
    )
    parser.add_argument(
        "--out", metavar="URL", required=True, help="folder of the outputs, which keeps the tree of FILES"
    )
    parser.add_argument(
        "--report", metavar="URL", required=True, help="folder of the report: Parquet files, a row for each of FILES"
    )
    parser.add_argument(
        "--root", metavar="URL", help="folder of FILES that --out stands for (default: of the glob)"
    )
    parser.add_argument("--shard", metavar="I/N", type=_shard, default=(1, 1), help="the I-th of N parts of FILES")
    parser.add_argument("--overwrite", action="store_true", help="do again what is done")
    parser.add_argument(
        "--retries", metavar="N", type=int, default=2, help="further attempts after errors of storage or OpenCL"
    )
    parser.add_argument("--quiet", action="store_true", help="show no progress")

    place = parser.add_argument_group("where")
    schedulers = place.add_mutually_exclusive_group()
    schedulers.add_argument(
        "--scheduler", metavar="ADDRESS", help="of a Dask scheduler (default: processes of this machine)"
    )
    schedulers.add_argument("--scheduler-file", metavar="FILE", help="that a Dask scheduler wrote")
    place.add_argument("--workers", metavar="N", type=_count, help="processes on this machine (default: one a core)")
    place.add_argument(
        "--encoders",
        metavar="N",
        type=_count,
        help="files at the same time in each process (default: its share of the cores)",
    )
    place.add_argument(
        "--threads",
        metavar="N",
        type=_count,
        help='threads of each file on the device "host" (default: one, or more where files are few; not with --unpack)',
    )
    place.add_argument(
        "--device",
        metavar="NAME",
        action="append",
        dest="devices",
        help="a device, as --device of gscl; given several times, the workers of a machine share them evenly (not with "
        "--unpack)",
    )

    settings = parser.add_argument_group(
        "encoding, as in gscl.encode (with --pack: --bytes, --bpp, --psnr, by default the finest steps; --bare)"
    )
    add_targets(settings)
    settings.add_argument("--effort", metavar="0..9", type=int, help="default: 5")
    settings.add_argument("--tune", choices=["auto", "psnr", "ssim", "visual"])
    settings.add_argument("--seed", metavar="N", type=int)
    settings.add_argument("--progressive", action="store_true", default=None, help="write layers")
    settings.add_argument("--icc-profile", action="store_true", default=None, help="keep the colour profile")
    settings.add_argument("--exif", action="store_true", default=None, help="keep EXIF metadata")
    settings.add_argument("--xmp", action="store_true", default=None, help="keep XMP metadata")
    settings.add_argument(
        "--bare", action="store_true", default=None, help="write the picture alone; with --unpack, read such files"
    )

    fields = parser.add_argument_group("with --pack, as in gscl.batch.pack")
    fields.add_argument(
        "--loader", metavar="NAME", choices=get_args(LoaderName), help="one of %(choices)s (default: as the names end)"
    )
    fields.add_argument("--size", metavar="WxH", type=numbers("WxH", "x"), help="of all pictures, if FILES do not say it")
    fields.add_argument("--blend", choices=["normalized", "alpha", "sum"], help="if FILES do not say it")
    fields.add_argument(
        "--background", metavar="R,G,B", type=_colour, help="each 0 to 1, if FILES do not say it (default: black)"
    )
    fields.add_argument("--no-passes", action="store_false", default=None, dest="passes", help="keep all splats")
    fields.add_argument("--refine", metavar="0..9", type=int, help="let the splats move (default: 0, not at all)")
    fields.add_argument(
        "--tolerance", metavar="T", type=float, help="difference that the format may make, 0 to 1 (default: 0.01)"
    )
    return parser


class _Kind(NamedTuple):
    """What is done with all files."""

    call: Callable[..., Summary]
    done: str
    """In the line at the end."""
    settings: list[str]
    """Arguments of `call` that only some kinds of runs have."""


_SHARED = ["bytes", "bpp", "psnr", "threads", "devices", "bare"]
_ENCODE = ["preset", "quality", "ssimulacra2", "splats", "effort", "tune", "seed", "progressive", "icc_profile", "exif", "xmp"]
_PACK = ["loader", "size", "blend", "background", "passes", "refine", "tolerance"]
_KINDS = {
    "encode": _Kind(run, "encoded", _SHARED + _ENCODE),
    "pack": _Kind(pack, "packed", _SHARED + _PACK),
    "unpack": _Kind(unpack, "unpacked", ["bare"]),
}
_FLAGS = {"devices": "--device", "passes": "--no-passes"}  # of settings with another name


def _settings(parser: argparse.ArgumentParser, options: argparse.Namespace) -> dict[str, Any]:
    """The settings that were given, which must be some of this kind of run."""
    names = _SHARED + _ENCODE + _PACK
    given = {name: getattr(options, name) for name in names if getattr(options, name) is not None}
    wrong = [_FLAGS.get(name, "--" + name.replace("_", "-")) for name in given if name not in _KINDS[options.kind].settings]
    if wrong:
        where = "without --pack" if options.kind == "encode" else f"with --{options.kind}"
        parser.error(f"{', '.join(wrong)}: has no meaning {where}")
    return given


class _Line:
    """The line of progress: rewritten in a terminal, else a further line every ten seconds."""

    def __init__(self) -> None:
        self.shown = 0.0
        self.is_terminal = sys.stderr.isatty()

    def show(self, state: BatchProgress) -> None:
        is_end = state.done == state.total
        if not self.is_terminal and not is_end and state.elapsed_s < self.shown + 10:
            return
        self.shown = state.elapsed_s
        rate = state.done / state.elapsed_s if state.elapsed_s > 0 else 0.0
        left = _duration((state.total - state.done) / rate) if rate else "?"
        part = state.done / state.total if state.total else 1.0
        bar = "#" * round(20 * part)
        text = f"[{bar:20}] {part:4.0%} {state.done}/{state.total}, {state.failed} failed, {rate:.1f}/s, "
        text += f"{state.encoders} encoders, {left} left"
        print(
            "\r" + text + "\033[K" if self.is_terminal else text, end="" if self.is_terminal else "\n", file=sys.stderr
        )
        if self.is_terminal and is_end:
            print(file=sys.stderr)
        sys.stderr.flush()


def _duration(seconds: float) -> str:
    minutes, seconds = divmod(round(seconds), 60)
    return f"{minutes // 60}:{minutes % 60:02d}:{seconds:02d}"


def _fail(message: str, status: int = 1) -> NoReturn:
    print(f"gscl.batch: {message}", file=sys.stderr)
    sys.exit(status)


def main(arguments: list[str] | None = None) -> int:
    parser = _parser()
    options = parser.parse_args(arguments)
    if (options.scheduler or options.scheduler_file) and (options.workers or options.encoders):
        parser.error(
            "--workers and --encoders are of this machine's processes: give those of a scheduler to `dask worker`"
        )
    kind, settings = _KINDS[options.kind], _settings(parser, options)
    client = None
    connect: Any = distributed.Client  # has no types
    try:
        if options.scheduler or options.scheduler_file:
            client = connect(options.scheduler, scheduler_file=options.scheduler_file)
        summary = kind.call(
            options.files,
            options.out,
            options.report,
            client=client,
            workers=options.workers,
            encoders=options.encoders,
            root=options.root,
            shard=options.shard,
            retries=options.retries,
            overwrite=options.overwrite,
            progress=None if options.quiet else _Line().show,
            **settings,
        )
    except KeyboardInterrupt:
        _fail("interrupted; the same command continues", 130)
    except (Error, ImportError, OSError) as error:
        _fail(f"{type(error).__name__}: {error}" if isinstance(error, OSError) and not error.strerror else str(error))
    finally:
        if client is not None:
            client.close()
    print(
        f"{summary.ok} {kind.done}, {summary.exists} existed, {summary.skipped} done before, {summary.failed} failed; "
        f"{summary.bytes} bytes, {summary.seconds:.1f} s"
    )
    return 1 if summary.failed else 0


if __name__ == "__main__":
    sys.exit(main())
