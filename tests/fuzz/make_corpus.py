#!/usr/bin/env python3
"""Writes the inputs of the fuzz targets into tests/fuzz/corpus/reader: make_corpus.py [--gscl PROGRAM]

Each is a small file of a kind of its own.  Run it after a change of the format.
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "cli"))

from gscl_file import contained, header  # noqa: E402
from images import Image, png_bytes, scene  # noqa: E402

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


def encoded(gscl, image, *options):
    with tempfile.TemporaryDirectory() as folder:
        source, output = pathlib.Path(folder, "in.png"), pathlib.Path(folder, "out.gscl")
        source.write_bytes(png_bytes(image))
        subprocess.run([gscl, "encode", "-q", source, "-o", output, "--effort=1", "--splats=12", *options], check=True)
        return output.read_bytes()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--gscl", default="build/gscl", help="program that encodes (default %(default)s)")
    gscl = parser.parse_args().gscl
    files = {name: encoded(gscl, scene(40, 30, channels, depth), *options)
             for name, (channels, depth, *options) in KINDS.items()}
    files["flat"] = encoded(gscl, Image(16, 9, 3, 8, [200, 30, 7] * (16 * 9)))
    picture = files["scalar_grey"][5:-2]
    files["bare"] = picture
    files["blocks"] = contained(picture, before=b"\x00\x02\x01\x0d\x01\x04abcd\x9e\x00", after=b"\x20\x03II*\xa1\x02xm")
    files["huge"] = contained(header(16384, 16384, 1 << 20).finish())
    folder = HERE / "corpus/reader"
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.gsc*"):
        old.unlink()
    for name, data in files.items():
        (folder / f"{name}.gscl").write_bytes(data)
        print(f"{name}: {len(data)} bytes")


if __name__ == "__main__":
    main()
