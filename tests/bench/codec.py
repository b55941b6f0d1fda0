"""Runs gscl on a folder of images and averages the measurements, for the scripts in this folder.

Every figure comes from a file that was encoded under a byte budget, decoded, and compared with the original by
`gscl compare`.  The rate is the size of the file.
"""
import argparse
import csv
import json
import math
import pathlib
import shlex
import subprocess
import sys
import tempfile
import time


TUNE_PSNR = ("--tune", "psnr")  # of benchmarks of PSNR and speed; the default tune is another


def parser(about):
    """A parser with the options of all scripts."""
    result = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    result.add_argument("folder", help="folder of PNG images")
    result.add_argument("--gscl", default="build/gscl", help="program to measure (default %(default)s)")
    result.add_argument("--only", default="", help="names of images, separated by commas")
    return result


def parse_with_options(parser):
    """Parses the command line; the words after -- become arguments.options, which gscl encode receives."""
    words = sys.argv[1:]
    at = words.index("--") if "--" in words else len(words)
    arguments = parser.parse_args(words[:at])
    arguments.options = words[at + 1:]
    return arguments


def run(*words):
    """Runs a command; returns (seconds, its JSON output or {})."""
    start = time.perf_counter()
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    seconds = time.perf_counter() - start
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, words))}: {done.stderr.strip()}")
    text = done.stdout.strip()
    return seconds, json.loads(text) if text.startswith("{") else {}


def images_of(folder, only=""):
    paths = sorted(pathlib.Path(folder).glob("*.png"))
    if only:
        paths = [path for path in paths if path.stem in only.split(",")]
    if not paths:
        raise SystemExit(f"{folder}: holds no PNG image of the names given; name a folder of PNG images")
    return paths


def reduced(path, longer):
    """The picture of a file as RGB, reduced to a longer side of so many pixels; 0: as it is."""
    from PIL import Image  # only scripts that reduce pictures need Pillow
    with Image.open(path) as opened:
        image = opened.convert("RGB")
    if not longer:
        return image
    scale = longer / max(image.size)
    return image.resize([max(1, round(side * scale)) for side in image.size], Image.LANCZOS)


def compare(gscl, a, b):
    """The measures of `gscl compare`; NaN where one does not apply, as MS-SSIM of a small image."""
    _, measures = run(gscl, "compare", a, b, "--json")
    return {key: math.nan if value is None else value for key, value in measures.items()}


def measure(gscl, image, rate, options, work):
    """Encodes one image at `rate` bits per pixel; returns bpp, psnr, ssim, ms_ssim, ssimulacra2 and seconds."""
    coded, decoded = work / "image.gscl", work / "image.png"
    encode_s, _ = run(gscl, "encode", image, "-o", coded, "--bpp", rate, "--quiet", "--json", *options)
    decode_s, _ = run(gscl, "decode", coded, "-o", decoded)
    quality = compare(gscl, image, decoded)
    _, header = run(gscl, "info", coded, "--json")
    pixels = header["width"] * header["height"]
    size = coded.stat().st_size
    return dict(image=image.stem, rate=rate, bpp=8 * size / pixels, over=size > int(rate * pixels / 8), splats=header["splats"],
                psnr=quality["psnr"], ssim=quality["ssim"], ms_ssim=quality["ms_ssim"],
                ssimulacra2=quality["ssimulacra2"], encode_s=encode_s, decode_s=decode_s)


def add_variants(parser, sizes):
    """Adds --bytes and --variant, for scripts that compare sets of options at equal bytes."""
    parser.add_argument("--bytes", default=sizes, help="sizes of files (default %(default)s)")
    parser.add_argument("--variant", action="append", dest="variants", metavar="OPTIONS",
                        help="options of gscl encode; may be given several times (default: '--tune visual', then '--tune psnr')")


def parse_variants(parser):
    """Parses the command line: arguments.variants, and arguments.budgets in bytes."""
    arguments = parser.parse_args()
    arguments.variants = arguments.variants or ["--tune visual", "--tune psnr"]
    arguments.budgets = [int(size) for size in arguments.bytes.split(",")]
    return arguments


def name_of(variant):
    return f"gscl {variant}".strip()


def code_variant(gscl, variant, image, budget, work):
    """Encodes and decodes one image within a number of bytes; returns the bytes and the decoded file."""
    coded, decoded = work / "image.gscl", work / "image.png"
    options = shlex.split(variant)
    run(gscl, "encode", image, "-o", coded, "--bytes", budget, "--quiet", *options)
    run(gscl, "decode", coded, "-o", decoded, *(["--bare"] if "--bare" in options else []))
    size = coded.stat().st_size
    if size > budget:
        raise SystemExit(f"{image}: {name_of(variant)} made {size} bytes, more than the {budget} allowed")
    return size, decoded


def mean(rows, key):
    return sum(row[key] for row in rows) / len(rows)


def write_csv(path, rows):
    """Writes rows of the same columns, which are dictionaries."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)


def measured(arguments, images, measure_image):
    """The rows that measure_image(arguments, image, folder for files) makes of each image; also in the file of --csv."""
    with tempfile.TemporaryDirectory() as folder:
        rows = [row for image in images for row in measure_image(arguments, image, pathlib.Path(folder))]
    if arguments.csv:
        write_csv(arguments.csv, rows)
    return rows


def at_rate(points, rate):
    """The quality at a rate (or size), linear in its logarithm; None outside the points (with 3 % of tolerance)."""
    if not points[0][0] / 1.03 <= rate <= points[-1][0] * 1.03:
        return None
    for (low, a), (high, b) in zip(points, points[1:]):
        if rate <= high or (high, b) == points[-1]:
            return a + (b - a) * (math.log(rate) - math.log(low)) / (math.log(high) - math.log(low))
    return None
