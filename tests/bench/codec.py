"""Runs gscl on a folder of images and averages what it says: shared by the scripts beside it.

Every figure comes from a real file: encoded under a byte budget, decoded, and compared with the original by
`gscl compare`; rate is the size of the file.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import time


def parser(about):
    """Options that all scripts have."""
    result = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    result.add_argument("folder", help="of PNG images")
    result.add_argument("--gscl", default="build/gscl")
    result.add_argument("--only", default="", help="names of images, separated by commas")
    return result


def parse_with_options(parser):
    """Parses the command line; words after -- become arguments.options, for gscl encode."""
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
        raise SystemExit(f"{folder}: there are no PNG images in it")
    return paths


def measure(gscl, image, rate, options, work):
    """Encodes one image at `rate` bits per pixel; returns bpp, psnr, ssim, ms_ssim and seconds."""
    coded, shown = work / "picture.gscl", work / "picture.png"
    info = run(gscl, "encode", image, "-o", coded, "--bpp", rate, "-q", "--json", *options)
    decode_s, _ = run(gscl, "decode", coded, "-o", shown)
    _, quality = run(gscl, "compare", image, shown, "--json")
    _, header = run(gscl, "info", coded, "--json")
    pixels = header["width"] * header["height"]
    size = coded.stat().st_size
    return dict(image=image.stem, rate=rate, bpp=8 * size / pixels, over=size > int(rate * pixels / 8), splats=header["splats"],
                psnr=quality["psnr"], ssim=quality["ssim"], ms_ssim=quality["ms_ssim"], encode_s=info[0], decode_s=decode_s)


def mean(rows, key):
    return sum(row[key] for row in rows) / len(rows)
