#!/usr/bin/env python3
"""Writes the inputs from which the fuzz targets start: make_corpus.py [--gscl PROGRAM] [TARGET...]

Each is a small input of a kind of its own, tests/fuzz/corpus/TARGET/NAME.TARGET; for the reader, whose inputs are files,
NAME.gscl.  Inputs that were found by fuzzing stay.  Run it after a change of the format.
"""
import argparse
import pathlib
import struct
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "cli"))

from gscl_file import contained, header  # noqa: E402
from images import Image, png_bytes, scene  # noqa: E402
from image_seeds import seeds as image_seeds  # noqa: E402

KINDS = {
    "scalar_photo": (3, 8, "--effects=-texture"),
    "scalar_grey": (1, 8, "--effects=-texture"),
    "scalar_textured": (3, 8, "--effects=+texture", "--effort=3"),
    "scalar_everything": (4, 16, "--effects=+texture,+opacity,+alpha-channel", "--effort=3"),
    "scalar_circles": (2, 8, "--effects=-anisotropy", "--blend=alpha"),
    "scalar_sum": (3, 8, "--blend=sum", "--effects=-rotation"),
    "codebook_photo": (3, 8, "--profile=paper", "--codebook=4"),
    "codebook_grey": (1, 8, "--profile=paper", "--codebook=2"),
    "codebook_everything": (4, 16, "--profile=paper", "--codebook=3", "--effects=+alpha-channel"),
}


PACKETS = {
    "four": ("--packet-count=4",),
    "lossy": ("--packet-count=5", "--packet-loss=0.4"),
    "many": ("--packet-count=8", "--packet-loss=0.1"),
    "grey": ("--packet-count=2", "--effects=-chroma"),
}


def encoded(gscl, image, *options, target=("--splats=12",)):
    with tempfile.TemporaryDirectory() as folder:
        source, output = pathlib.Path(folder, "in.png"), pathlib.Path(folder, "out.gscl")
        source.write_bytes(png_bytes(image))
        subprocess.run([gscl, "encode", "--quiet", source, "-o", output, "--effort=1", *target, *options], check=True)
        return output.read_bytes()


# Command lines, one word a line; the first names the command.
COMMAND_LINES = {
    "encode": "encode a.png -o a.gscl --bytes 2000 --effort=9 --quiet --effects=+texture,-chroma --seed 18446744073709551615",
    "encode_batch": "encode --files-from - --out-dir out --keep-tree --jobs 2 --shard 3/7 --jsonl - --skip-existing -0",
    "encode_rate": "encode a.png --bpp 0.125 --psnr 30.5 --blend alpha --tune visual --profile paper --codebook 32",
    "decode": "decode a.gscl -o a.png --size 640x480 --crop 1,2,30,40 --scale 2.5 --partial --base64 --max-pixels 9",
    "background": "decode a.gscl -o a.jpg --background=#fA0",
    "background_name": "draw a.gscl -o a.jpg --background rebeccapurple",
    "info": "info a.gscl --reference a.png --json",
    "compare": "compare a.png b.png --json",
    "draw": "draw a.gscl -o b.png",
    "export": "export a.gscl -o a.svg",
    "pack": "pack a.ply -o a.gscl --psnr 30 --refine 3 --size 64x48 --background 0.5,1,0 --blend sum --tolerance 0.1",
    "devices": "devices --check",
    "bench": "bench --json",
    "tradeoff": "tradeoff a.png",
    "help": "encode --help=man",
    "missing_value": "encode a.png --bytes",
    "bundle": "encode -qv0oa.gscl a.png",
    "end_of_options": "decode -- -a.gscl",
}


def reader_seeds(gscl):
    files = {name: encoded(gscl, scene(40, 30, channels, depth), *options)
             for name, (channels, depth, *options) in KINDS.items()}
    files["flat"] = encoded(gscl, Image(16, 9, 3, 8, [200, 30, 7] * (16 * 9)))
    picture = files["scalar_grey"][5:-2]
    files["bare"] = picture
    files["blocks"] = contained(picture, before=b"\x00\x02\x01\x0d\x01\x04abcd\x9e\x00", after=b"\x20\x03II*\xa1\x02xm")
    files["huge"] = contained(header(16384, 16384, 1 << 20).finish())
    return {f"{name}.gscl": data for name, data in files.items()}


def packets_seeds(gscl):
    target = "--packets=60", "--packet-identity=1"
    return {f"{name}.packets": encoded(gscl, scene(40, 30, 3, 8), *options, target=target) for name, options in PACKETS.items()}


def field_seeds(gscl):
    """Tables as gscl export writes them, and other columns."""
    seeds = {}
    for name in ("scalar_photo", "scalar_sum", "scalar_textured"):
        channels, depth, *options = KINDS[name]
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder, "in.gscl")
            source.write_bytes(encoded(gscl, scene(40, 30, channels, depth), *options, target=("--splats=3",)))
            for kind in ("ply", "csv"):
                done = subprocess.run([gscl, "export", source, "-o", "-", f"--{kind}"], check=True, capture_output=True)
                seeds[f"{name}_{kind}"] = done.stdout
    seeds["covariance"] = b"x,y,cov_xx,cov_xy,cov_yy,grey,weight\n1,2,3,0.5,4,1,2\n"
    seeds["cholesky"] = b"# gscl width=9 height=8 blend=normalized background=1\nx, y, l11, l21, l22, red, green, blue\n1,2,3,0,4,1,0,-1\n"
    seeds["comment_alone"] = b"# "  # whose end was not seen
    head = "".join(f"property {kind} {name}\n" for kind, name in zip(
        "double float uchar char short ushort int uint float".split(), "x y sigma1 sigma2 red green blue layer theta".split()))
    head = f"ply\nformat binary_little_endian 1.0\nobj_info a\nelement vertex 2\n{head}element face 0\nproperty int a\nend_header\n"
    seeds["binary"] = head.encode() + 2 * struct.pack("<dfBbhHiIf", 1.5, 2, 3, 4, -1, 1, -2, 1, 0.5)
    return {f"{name}.field": data for name, data in seeds.items()}


def write_seeds(target, files):
    folder = HERE / "corpus" / target
    folder.mkdir(parents=True, exist_ok=True)
    for old in (*folder.glob("*.gsc*"), *folder.glob(f"*.{target}")):
        old.unlink()
    for name, data in files.items():
        (folder / name).write_bytes(data)
        print(f"{target}/{name}: {len(data)} bytes")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--gscl", default="build/gscl", help="program that encodes (default %(default)s)")
    parser.add_argument("targets", nargs="*", help="field, reader, packets, image, options (default: all)")
    arguments = parser.parse_args()
    makers = {"field": lambda: field_seeds(arguments.gscl),
              "reader": lambda: reader_seeds(arguments.gscl),
              "packets": lambda: packets_seeds(arguments.gscl),
              "image": lambda: {f"{name}.image": data for name, data in image_seeds()},
              "options": lambda: {f"{name}.options": line.replace(" ", "\n").encode() for name, line in COMMAND_LINES.items()}}
    for target in arguments.targets or makers:
        write_seeds(target, makers[target]())


if __name__ == "__main__":
    main()
