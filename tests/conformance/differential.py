#!/usr/bin/env python3
"""Compares all decoders on random files: differential.py [--files N] [--seed N] [--keep FOLDER] BUILD

Random codes (random_scenes.py) are written as files by the library.  The decoders are that of the device "host", that of
OpenCL in the mapping of CPUs and in that of GPUs, unless the library was built without OpenCL, that of web pages in Node,
where BUILD has it, and gscl_decoder.py.  All must
read the same codes.  What gscl_decoder.py draws in double precision is the exact picture, from which the samples of the others
may differ as much as FORMAT.md, "Precision", allows.  A third of the files is also damaged or cut: then all must give the
same result.  Others are also divided into packets, of which some are lost or damaged; the decoder of web pages reads no lists.  The report counts features and results, and shows the largest differences: of a decoder from the exact
picture in units of what is allowed, of two decoders in units of what the bounds of both allow.

Ends with status 1 when decoders disagree, and names the seed and the file, which --keep keeps.
"""
import argparse
import collections
import itertools
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "decoder"), str(HERE.parent / "cli")]

import gscl_decoder as gscl
from codes import Codes, form
from gscl_file import crc16
from packet_lists import listed, sealed
from random_scenes import random_scene

BATCH = 250  # files that a process of each decoder gets
EXACT, HOST, CPU, GPU, WEB = "exact", "host", "opencl-cpu", "opencl-gpu", "web"
WORDS = {"decode-host": HOST, "decode-cpu": CPU, "decode-gpu": GPU}  # of codes.c
MAX_PIXELS, MAX_SPLATS = 10000, 2000  # of damaged files that are drawn


class File:
    """A file to compare.  `problems` says in what the decoders disagree."""

    def __init__(self, name, path, bare, features=(), is_list=False):
        self.name, self.path, self.bare, self.features, self.is_list = name, path, bare, features, is_list
        self.result, self.codes, self.bounds, self.pictures, self.problems = None, "", None, {}, []


# ---- Making files ---------------------------------------------------------------------------------------------------

def valid_file(codes, folder, seed, kinds):
    scene, features = random_scene(seed, kinds)
    bare = seed % 5 == 0 and not scene.blocks
    text, path = folder / "codes.txt", folder / f"{seed}.gscl"
    text.write_text(scene.codes())
    codes.run("write", text, path, *(["bare"] if bare else []))
    return File(f"seed {seed}", path, bare, features | {"bare" if bare else "container"})


def damaged_file(file, seed):
    """The file with a byte changed or without its end, with or without a check that matches; or in the other form."""
    pick = random.Random(-seed)
    data, bare = bytearray(file.path.read_bytes()), file.bare
    kind = pick.choice(("byte", "byte", "cut", "long", "form"))
    if kind == "byte":
        data[pick.randrange(len(data))] ^= 1 << pick.randrange(8) if pick.random() < 0.5 else pick.randint(1, 255)
    elif kind == "cut":
        del data[pick.randrange(len(data)):]
    elif kind == "long":
        data.insert(pick.randrange(len(data) + 1), pick.randrange(256))
    else:
        bare = not bare
    if not bare and len(data) > 7 and pick.random() < 0.7:
        data[-2:] = crc16(bytes(data[:-2])).to_bytes(2, "big")
    path = file.path.with_suffix(".damaged")
    path.write_bytes(data)
    return File(f"{file.name}, {kind}", path, bare, {"damaged: " + kind})


def packet_list(codes, folder, seed, kinds):
    """A list of packets in any order, of which some are lost, repeated, damaged, or changed with a check that matches."""
    scene, features = random_scene(seed, kinds)
    if scene.coding == gscl.CODEBOOK or scene.layers > 1 or scene.blocks:
        return
    pick = random.Random(seed)
    text, path = folder / "codes.txt", folder / f"{seed}.gsclp"
    text.write_text(scene.codes())
    count, repairs = pick.choice((1, 2, 2, 3, 5, 8, 40)), pick.choice((0, 0, 1, 2, 4))
    codes.run("packets", text, path, pick.choice((0, 7, 255)), count, repairs, *pick.choice(([], ["everywhere"])))
    packets = gscl.packets_of(path.read_bytes())
    kept = packets[:1] + [changed_packet(packet, pick) for packet in packets * 2 if pick.random() < 0.4]
    path.write_bytes(listed(pick.sample(kept, len(kept))))
    yield File(f"seed {seed}, {count} packets", path, False, {"packets", "repair packets" if repairs else "no repair packets"}, True)


def changed_packet(packet, pick):
    at, kind = pick.randrange(len(packet)), pick.random()
    changed = packet[:at] + bytes([packet[at] ^ 1 << pick.randrange(8)]) + packet[at + 1:]
    return packet if kind < 0.8 else changed if kind < 0.9 else sealed(changed[:-2])


def make_files(codes, folder, seeds, kinds):
    for seed in seeds:
        file = valid_file(codes, folder, seed, kinds)
        yield file
        if seed % 3 == 0:
            yield damaged_file(file, seed)
        if seed % 3 > 0:
            yield from packet_list(codes, folder, seed, kinds)


# ---- The exact picture ----------------------------------------------------------------------------------------------

def decode_exactly(file):
    try:
        picture = gscl.decode(file.path.read_bytes(), file.bare)
    except gscl.Refused as error:
        file.result = error.result.replace(" ", "-")
        return
    file.result, file.codes = "valid", picture.codes()
    if picture.width * picture.height <= MAX_PIXELS and picture.n <= MAX_SPLATS:
        file.size = [picture.width, picture.height, channels_of(picture), 16 if picture.high_bit_depth else 8]
        file.bounds = [bound for row in picture.draw_with_scale() for values, scale in row
                       for bound in sample_bounds(picture, values, max(1, scale / 4) / 255)]


def channels_of(picture):
    """Of its output: grey, grey with alpha, RGB, or RGB with alpha."""
    return 1 + 2 * (picture.layout >= gscl.RGB) + picture.layout % 2


def sample_bounds(picture, values, tolerance):
    """(lowest, exact, highest) of each sample of a pixel, 0..1."""
    near = [picture.output(list(corner)) for corner in corners(picture, values, tolerance)]
    return [(min(sample), sample[0], max(sample)) for sample in zip(*near)]


def corners(picture, values, tolerance):
    """The exact values and those that give the smallest and largest samples, each of which is monotonous in all values."""
    moved = lambda *signs: [value + sign * tolerance for value, sign in zip(values, signs)]
    colours = len(values) - picture.has_alpha
    yield values
    for colour, alpha in itertools.product((-1, 1), repeat=2):
        yield moved(*[colour] * colours, *[alpha] * picture.has_alpha)
    if picture.has_alpha and abs(values[-1]) <= tolerance:
        yield [*moved(*[1] * colours)[:colours], 1e-300]  # an alpha just above 0


# ---- The other decoders ---------------------------------------------------------------------------------------------

def by_form(files):
    """Files of either form, and their paths."""
    for bare in False, True:
        chosen = [file for file in files if file.bare == bare]
        yield bare, chosen, [file.path for file in chosen]


def compare(file, decoder, what, found, expected):
    if found != expected:
        file.problems.append(f"{decoder}: {what} {found}, expected {expected}" if len(str(found)) < 100 else f"{decoder}: {what}")


def read_by_library(codes, files):
    for bare, chosen, paths in by_form(files):
        for file, (result, text) in zip(chosen, codes.read(bare, paths), strict=True):
            compare(file, "library", "result", result, file.result)
            compare(file, "library", "codes", text, file.codes)


def draw_by_library(codes, folder, files):
    for word in codes.run("decoders").split():
        for bare, chosen, paths in by_form([file for file in files if file.bounds is not None]):
            for file, (result, size, samples) in zip(chosen, codes.decode(word, bare, paths, folder), strict=True):
                compare(file, WORDS[word], "result", result, "valid")
                compare(file, WORDS[word], "size", size, file.size)
                file.pictures[WORDS[word]] = [value * 255 / ((1 << size[3]) - 1) for value in samples] if size else []


def decode_by_web(web, folder, files):
    files = [file for file in files if not file.is_list]
    lines = [f'{form(file.bare)} {"read" if file.bounds is None else "draw"} {file.path}\n' for file in files]
    results = subprocess.run(["node", str(HERE / "decode_all.mjs"), str(web), str(folder)], check=True, text=True,
                             input="".join(lines), stdout=subprocess.PIPE).stdout.split()
    for number, (file, result) in enumerate(zip(files, results, strict=True)):
        compare(file, WEB, "result", result, file.result)
        if file.bounds is not None and result == "valid":
            file.pictures[WEB] = of_rgba((folder / f"{number}.rgba").read_bytes(), file.size[2])


def of_rgba(data, channels):
    """The samples of a layout; grey files must have three equal samples, opaque ones an alpha of 255."""
    pixels = [data[i:i + 4] for i in range(0, len(data), 4)]
    kept = {1: (0,), 2: (0, 3), 3: (0, 1, 2), 4: (0, 1, 2, 3)}[channels]
    if channels < 3 and any(not p[0] == p[1] == p[2] for p in pixels) or channels % 2 and any(p[3] != 255 for p in pixels):
        return []
    return [pixel[k] for pixel in pixels for k in kept]


# ---- Comparison -----------------------------------------------------------------------------------------------------

def excess(sample, half, low, exact, high):
    """How far a sample, of which the value is within `half`, is from the exact one, in units of what is allowed.  Colours that
    are divided by an alpha near 0 may have any value."""
    if high - low >= 255:
        return 0.0
    if sample - half > exact:
        return (sample - half - exact) / (high - exact) if high > exact else float("inf")
    if sample + half < exact:
        return (exact - sample - half) / (exact - low) if low < exact else float("inf")
    return 0.0


def compare_pictures(file, largest):
    """Adds the largest differences, by decoder and by pair."""
    halves = {name: 0.5 if file.size[3] == 8 or name == WEB else 0.5 / 257 for name in file.pictures}
    bounds = [tuple(255 * v for v in bound) for bound in file.bounds]
    for name, samples in file.pictures.items():
        if len(samples) != len(bounds):
            file.problems.append(f"{name}: not the samples of this layout")
            return
        worst = max(excess(sample, halves[name], *bound) for sample, bound in zip(samples, bounds))
        keep_largest(largest, (EXACT, name), worst, file)
        if worst > 1 + 1e-9:
            file.problems.append(f"{name}: a sample differs from the exact one by {worst:.3f} of what is allowed")
    for a, b in itertools.combinations(file.pictures, 2):
        rounding = halves[a] + halves[b]
        worst = max(abs(u - v) / (high - low + rounding)
                    for u, v, (low, _, high) in zip(file.pictures[a], file.pictures[b], bounds))
        keep_largest(largest, (a, b), worst, file)


def keep_largest(largest, pair, value, file):
    if value > largest.get(pair, (-1, ""))[0]:
        largest[pair] = value, file.name


class Comparison:
    """What has been found in the files so far."""

    def __init__(self, codes, web=None, kinds=None):
        self.codes, self.web, self.kinds = codes, web, kinds
        self.largest, self.features, self.results, self.failed = {}, collections.Counter(), collections.Counter(), []
        self.valid = self.lists = self.drawn = 0

    def add(self, seeds, keep=None):
        """Compares the files of these seeds."""
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            files = list(make_files(self.codes, folder, seeds, self.kinds))
            for file in files:
                decode_exactly(file)
            read_by_library(self.codes, files)
            draw_by_library(self.codes, folder, files)
            if self.web:
                decode_by_web(self.web, folder, files)
            for file in files:
                self.add_file(file, keep)

    def add_file(self, file, keep):
        if file.bounds is not None:
            compare_pictures(file, self.largest)
            self.drawn += 1
        self.features.update(file.features)
        damaged = any(feature.startswith("damaged") for feature in file.features)
        self.lists += file.is_list
        self.valid += not damaged and not file.is_list
        if damaged:
            self.results[file.result] += 1
        elif not file.is_list:
            compare(file, "library", "result of a file that was written:", file.result, "valid")
        if file.problems:
            self.failed.append(file)
            print(f'{file.name}: {"; ".join(file.problems)}', file=sys.stderr)
            if keep:
                shutil.copy(file.path, keep)

    def report(self):
        yield f"{self.valid} random files, {sum(self.results.values())} damaged ones, {self.lists} lists of packets; " \
              f"{self.drawn} drawn; {len(self.failed)} disagreements"
        yield "results of damaged files: " + ", ".join(f"{result} {n}" for result, n in self.results.most_common())
        yield "files by feature: " + ", ".join(f"{feature} {n}" for feature, n in sorted(self.features.items()))
        for (a, b), (value, where) in self.largest.items():
            yield f"largest difference {a} {b}: {value:.3f} ({where})"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", help="build folder of meson, with tests")
    parser.add_argument("--files", type=int, default=10000, help="number of random files (default %(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="seed of the first (default %(default)s)")
    parser.add_argument("--keep", help="folder for files on which decoders disagree")
    arguments = parser.parse_args()
    web = pathlib.Path(arguments.build, "host/web")
    comparison = Comparison(Codes(pathlib.Path(arguments.build, "tests/codes")), web if (web / "gscl.wasm").exists() else None)
    end = arguments.seed + arguments.files
    for first in range(arguments.seed, end, BATCH):
        comparison.add(range(first, min(first + BATCH, end)), arguments.keep)
        print(f"{comparison.valid} files, {len(comparison.failed)} disagreements", file=sys.stderr)
    print("\n".join(comparison.report()))
    sys.exit(1 if comparison.failed else 0)


if __name__ == "__main__":
    main()
