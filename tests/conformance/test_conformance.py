"""Runs the conformance set through the library and through the decoder in ../decoder.

The environment variable GSCL_CODES names the program of codes.c.
"""
import json
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "decoder"), str(HERE.parent / "cli")]

import gscl_decoder as gscl
from gscl_file import crc16
from images import Image, read_png
from make import Writer, make
from tool import main

CODES = os.environ["GSCL_CODES"]
FILES, PICTURES = HERE / "files", HERE / "pictures"
INDEX = json.loads((HERE / "index.json").read_text())
FORMS = {False: "whole", True: "bare"}
RESULTS = {gscl.NOT_GSCL, gscl.NEWER, gscl.TRUNCATED, gscl.DAMAGED, gscl.CORRUPT, gscl.UNKNOWN_BLOCK, "valid"}
MUTATIONS = 1  # of each byte of small pictures


def path(entry):
    return FILES / (entry["file"] + ".gscl")


def entries(bare, *results):
    return [entry for entry in INDEX if entry["bare"] == bare and (not results or entry["result"] in results)]


def codes(*arguments):
    return subprocess.run([CODES, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


def sections(output):
    """The words after "file" of each file, and the lines that follow."""
    parts = re.split(r"^file ", output, flags=re.M)[1:]
    return [(part.split("\n", 1)[0].split(), part.split("\n", 1)[1]) for part in parts]


def by_decoder(data, bare):
    """Result and codes as gscl_decoder finds them."""
    try:
        return "valid", gscl.decode(data, bare).codes()
    except gscl.Refused as error:
        return error.result.replace(" ", "-"), ""


class Conformance(unittest.TestCase):
    def test_index(self):
        """It lists every file, and every result occurs in it."""
        self.assertEqual({path(entry).name for entry in INDEX}, {file.name for file in FILES.iterdir()})
        self.assertEqual({entry["picture"] for entry in INDEX if "picture" in entry}, {file.name for file in PICTURES.iterdir()})
        self.assertEqual({entry["result"] for entry in INDEX}, {result.replace(" ", "-") for result in RESULTS})

    def test_library_reads(self):
        for bare in FORMS:
            chosen = entries(bare)
            read = sections(codes("read", FORMS[bare], *map(path, chosen)))
            for entry, (words, text) in zip(chosen, read, strict=True):
                self.check(entry, words[1], text)

    def test_decoder_reads(self):
        for entry in INDEX:
            self.check(entry, *by_decoder(path(entry).read_bytes(), entry["bare"]))

    def check(self, entry, result, text):
        with self.subTest(file=entry["file"]):
            self.assertEqual(result, entry["result"])
            if result == "valid":
                self.assertEqual(gscl.hash_of(text), entry["codes"], text)

    def test_library_decodes(self):
        self.check_decodes("decode")

    def test_library_decodes_without_opencl(self):
        self.check_decodes("decode-host")

    def check_decodes(self, word):
        for bare in FORMS:
            chosen = entries(bare)
            with tempfile.TemporaryDirectory() as folder:
                decoded = sections(codes(word, FORMS[bare], folder, *map(path, chosen)))
                for number, (entry, (words, _)) in enumerate(zip(chosen, decoded, strict=True)):
                    with self.subTest(file=entry["file"]):
                        self.assertEqual(words[1], entry["result"])
                        if len(words) > 2:
                            data = (pathlib.Path(folder) / f"{number}.raw").read_bytes()
                            self.check_picture(entry, image_of(data, *map(int, words[2:])))

    def test_decoder_draws(self):
        for entry in INDEX:
            if "picture" in entry:
                with self.subTest(file=entry["file"]):
                    picture = gscl.decode(path(entry).read_bytes(), entry["bare"])
                    self.check_picture(entry, read_png(gscl.png_bytes(picture)))

    def check_picture(self, entry, image):
        """Samples differ by at most 1/255, as the page allows."""
        step = image.peak // 255
        if "picture" in entry:
            expected = read_png((PICTURES / entry["picture"]).read_bytes())
            self.assertEqual(image.kind(), expected.kind())
            self.assertLessEqual(max(abs(a - b) for a, b in zip(image.samples, expected.samples, strict=True)), step)
        else:
            self.assertTrue(entry["samples"])
        for x, y, *expected in entry.get("samples", ()):
            pixel = image.crop(x, y, 1, 1).samples
            self.assertLessEqual(max(abs(a - b) for a, b in zip(pixel, expected, strict=True)), step)

    def test_prefixes(self):
        """Of every prefix of a valid file both readers find the same splats certain, and they refuse it by the same name."""
        for bare in FORMS:
            chosen = [entry for entry in entries(bare, "valid") if path(entry).stat().st_size < 100]
            for entry, (_, text) in zip(chosen, sections(codes("prefixes", FORMS[bare], *map(path, chosen))), strict=True):
                with self.subTest(file=entry["file"]):
                    data = path(entry).read_bytes()
                    expected = [prefix_line(data[:size], bare) for size in range(len(data) + 1)]
                    self.assertEqual(text.splitlines(), expected)

    def test_mutations(self):
        """Both readers agree on pictures of which a byte was changed, as to the result and the codes."""
        pick = random.Random(1)
        with tempfile.TemporaryDirectory() as folder:
            files = list(mutations(pathlib.Path(folder), pick))
            read = sections(codes("read", "bare", *files))
            results = set()
            for file, (words, text) in zip(files, read, strict=True):
                with self.subTest(file=file.name):
                    results.add(words[1])
                    self.assertEqual((words[1], text), by_decoder(file.read_bytes(), True))
            self.assertEqual(results, {"valid", "corrupt", "truncated"})

    def test_changed_blocks(self):
        """Both readers agree on complete files of which a byte was changed, with and without a check that matches."""
        with tempfile.TemporaryDirectory() as folder:
            files = list(changed_files(pathlib.Path(folder)))
            results = set()
            for file, (words, _) in zip(files, sections(codes("read", "whole", *files)), strict=True):
                with self.subTest(file=file.name):
                    results.add(words[1])
                    self.assertEqual(words[1], by_decoder(file.read_bytes(), False)[0])
            self.assertEqual(results, {result.replace(" ", "-") for result in RESULTS})

    def test_make(self):
        """make.py makes the set that is here."""
        with tempfile.TemporaryDirectory() as folder:
            made = pathlib.Path(folder)
            writer = Writer(CODES, made)
            make(writer)
            for entry in writer.index:
                with self.subTest(file=entry["file"]):
                    self.assertEqual((made / "files" / path(entry).name).read_bytes(), path(entry).read_bytes())
            self.assertEqual(writer.index, INDEX)


def image_of(data, width, height, channels, depth):
    samples = memoryview(data).cast("B" if depth == 8 else "H").tolist()
    return Image(width, height, channels, depth, samples)


def prefix_line(data, bare):
    try:
        picture = gscl.decode_prefix(data, bare)
        return f"prefix {len(data)} valid {len(picture.splats)} {picture.n}"
    except gscl.Refused as error:
        return f"prefix {len(data)} {error.result.replace(' ', '-')}"


def mutations(folder, pick):
    """Pictures of small valid files, each with one byte changed, as bare files."""
    for entry in INDEX:
        data = path(entry).read_bytes()
        if entry["result"] != "valid" or len(data) > 80 or not entry["bare"] and data[4] != 2:
            continue
        picture = data if entry["bare"] else data[5:-2]
        for at in range(len(picture)):
            for number in range(MUTATIONS):
                file = folder / f"{entry['file']}-{at}-{number}"
                file.write_bytes(picture[:at] + bytes([picture[at] ^ pick.randint(1, 255)]) + picture[at + 1:])
                yield file


def changed_files(folder):
    """Files with blocks, each with one byte changed to some values, and their starts."""
    for name in "blocks-empty", "block-unknown-after", "block-known-mandatory":
        data = (FILES / f"{name}.gscl").read_bytes()[:-2]
        for at in range(len(data)):
            for value in {0, 3, 0x7F, 0x80, 0xFF, data[at] ^ 0x40, data[at] ^ 0x20}:
                changed = data[:at] + bytes([value]) + data[at + 1:]
                for kind, check in ("sealed", crc16(changed)), ("open", crc16(data)):
                    file = folder / f"{name}-{at}-{value}-{kind}"
                    file.write_bytes(changed + check.to_bytes(2, "big"))
                    yield file
            file = folder / f"{name}-{at}-cut"
            file.write_bytes(data[:at])
            yield file


if __name__ == "__main__":
    main()
