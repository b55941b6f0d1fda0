"""Runs the conformance set through the library and through the decoder in ../decoder: test_conformance.py CODES [TEST...]

CODES is the program of codes.c, which may have been built for another machine (codes.py), or that of decode_single.c.
"""
import functools
import json
import pathlib
import random
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "decoder"), str(HERE.parent / "cli")]

import gscl_decoder as gscl
from codes import Codes
from gscl_file import crc16
from images import Image, read_png
from make import Writer, make
from packet_lists import listed, sealed
from tool import main

CODES = Codes(sys.argv.pop(1))
DECODERS = CODES.run("decoders").split()
FILES, PICTURES = HERE / "files", HERE / "pictures"
INDEX = json.loads((HERE / "index.json").read_text())
FORMS = False, True  # whole, bare
RESULTS = {gscl.NOT_GSCL, gscl.NEWER, gscl.TRUNCATED, gscl.DAMAGED, gscl.CORRUPT, gscl.UNKNOWN_BLOCK, "valid"}
EMULATED_PIXELS = 2
MUTATIONS = 1  # of each byte of small pictures


def path(entry):
    return FILES / (entry["file"] + (".gsclp" if entry.get("packets") else ".gscl"))


def entries(bare, *results):
    return [entry for entry in INDEX if entry["bare"] == bare and (not results or entry["result"] in results)]


def by_decoder(data, bare):
    """Result and codes as gscl_decoder finds them."""
    try:
        return "valid", gscl.decode(data, bare).codes()
    except gscl.Refused as error:
        return error.result.replace(" ", "-"), ""


class SetTest(unittest.TestCase):
    def check_reading(self, entry, result, text):
        with self.subTest(file=entry["file"]):
            self.assertEqual(result, entry["result"])
            if result == "valid":
                self.assertEqual(gscl.hash_of(text), entry["codes"], text)

    def check_samples(self, samples, expected, depth):
        """They differ by at most 1/255, as the page allows."""
        difference = max(abs(a - b) for a, b in zip(samples, expected, strict=True))
        self.assertLessEqual(difference, ((1 << depth) - 1) // 255)

    def check_picture(self, entry, image):
        if "picture" in entry:
            expected = read_png((PICTURES / entry["picture"]).read_bytes())
            self.assertEqual(image.kind(), expected.kind())
            self.check_samples(image.samples, expected.samples, image.depth)
        else:
            self.assertTrue(entry["samples"])
        for x, y, *expected in entry.get("samples", ()):
            self.check_samples(image.crop(x, y, 1, 1).samples, expected, image.depth)


class Decodes(SetTest):
    def check_decodes(self, decoder, index=INDEX):
        """Of files whose whole picture is not kept, an emulator draws some pixels only: the whole of two takes an hour."""
        self.right = 0
        for bare in FORMS:
            chosen = [entry for entry in index if entry["bare"] == bare]
            self.check_whole(decoder, bare, [entry for entry in chosen if not CODES.is_emulated or "samples" not in entry])
            self.check_pixels(bare, [entry for entry in chosen if CODES.is_emulated and "samples" in entry])
        print(f"# {decoder}: {self.right} of {len(index)} files right")

    def check_whole(self, decoder, bare, chosen):
        with tempfile.TemporaryDirectory() as folder:
            decoded = CODES.decode(decoder, bare, [*map(path, chosen)], folder)
            for entry, (result, size, samples) in zip(chosen, decoded, strict=True):
                with self.subTest(file=entry["file"]):
                    self.assertEqual(result, entry["result"])
                    if result == "valid":
                        self.check_picture(entry, Image(*size, samples))
                    self.right += 1

    def check_pixels(self, bare, chosen):
        for entry in chosen:
            with self.subTest(file=entry["file"]):
                some = entry["samples"][:EMULATED_PIXELS]
                found = CODES.pixels(bare, path(entry), [sample[:2] for sample in some])
                for (_, _, *expected), (depth, samples) in zip(some, found, strict=True):
                    self.check_samples(samples, expected, depth)
                self.right += 1


class Library(Decodes):
    def test_reads(self):
        for bare in FORMS:
            chosen = entries(bare)
            for entry, (result, text) in zip(chosen, CODES.read(bare, [*map(path, chosen)]), strict=True):
                self.check_reading(entry, result, text)

    @unittest.skipUnless("decode-cpu" in DECODERS, "the library has no OpenCL")
    def test_decodes_with_opencl(self):
        self.check_decodes("decode-cpu")

    def test_decodes_on_host(self):
        self.check_decodes("decode-host")


class Single(Decodes):
    """A decoder in single precision, which computes no packets: CODES is the program of decode_single.c."""

    def test_decodes(self):
        self.check_decodes("decode-single", [entry for entry in INDEX if "repaired" not in entry])


class Decoder(SetTest):
    """The decoder in Python, and the set itself."""

    def test_index(self):
        """It lists every file, and every result occurs in it."""
        self.assertEqual({path(entry).name for entry in INDEX}, {file.name for file in FILES.iterdir()})
        self.assertEqual({entry["picture"] for entry in INDEX if "picture" in entry}, {file.name for file in PICTURES.iterdir()})
        self.assertEqual({entry["result"] for entry in INDEX}, {result.replace(" ", "-") for result in RESULTS})

    def test_reads(self):
        for entry in INDEX:
            self.check_reading(entry, *by_decoder(path(entry).read_bytes(), entry["bare"]))

    def test_draws(self):
        for entry in INDEX:
            if "picture" in entry:
                with self.subTest(file=entry["file"]):
                    picture = gscl.decode(path(entry).read_bytes(), entry["bare"])
                    self.check_picture(entry, read_png(gscl.png_bytes(picture)))


class Both(unittest.TestCase):
    """The library and the decoder in Python, on files that are written again, and on parts and changed copies of them."""

    def test_prefixes(self):
        """Of every prefix of a valid file both readers find the same splats certain, and they refuse it by the same name."""
        for bare in FORMS:
            chosen = [entry for entry in entries(bare, "valid") if path(entry).stat().st_size < 100]
            for entry, lines in zip(chosen, CODES.prefixes(bare, [*map(path, chosen)]), strict=True):
                with self.subTest(file=entry["file"]):
                    data = path(entry).read_bytes()
                    self.assertEqual(lines, [prefix_line(data[:size], bare) for size in range(len(data) + 1)])

    def check_changed(self, make, bare, results, with_codes=True):
        """Both readers agree on the files that make(folder) writes, as to the result and the codes; `results`: those that occur."""
        with tempfile.TemporaryDirectory() as folder:
            files = list(make(pathlib.Path(folder)))
            found = set()
            for file, read in zip(files, CODES.read(bare, files), strict=True):
                with self.subTest(file=file.name):
                    found.add(read[0])
                    expected = by_decoder(file.read_bytes(), bare)
                    self.assertEqual(*((tuple(read), expected) if with_codes else (read[0], expected[0])))
            self.assertEqual(found, results)

    def test_mutations(self):
        """Pictures of which a byte was changed."""
        self.check_changed(functools.partial(mutations, pick=random.Random(1)), True, {"valid", "corrupt", "truncated"})

    def test_changed_blocks(self):
        """Complete files of which a byte was changed, with and without a check that matches."""
        self.check_changed(changed_files, False, {result.replace(" ", "-") for result in RESULTS}, with_codes=False)

    def test_changed_lists(self):
        """Lists of packets of which a byte was changed, with and without a check that matches."""
        self.check_changed(functools.partial(changed_lists, pick=random.Random(1)), False,
                           {"valid", "not-a-gscl-file", "truncated", "damaged"})

    def test_writes(self):
        """make.py makes the set that is here."""
        with tempfile.TemporaryDirectory() as folder:
            made = pathlib.Path(folder)
            writer = Writer(CODES, made)
            make(writer)
            for entry in writer.index:
                with self.subTest(file=entry["file"]):
                    self.assertEqual((made / "files" / path(entry).name).read_bytes(), path(entry).read_bytes())
            self.assertEqual(writer.index, INDEX)


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
        if entry["result"] != "valid" or len(data) > 80 or entry.get("packets") or not entry["bare"] and data[4] != 2:
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


def changed_lists(folder, pick):
    """Lists of packets with one byte changed, and with one byte of a packet changed whose check then matches."""
    for name in "packets-2", "packets-repair", "packets-empty", "packets-last-row":
        data = (FILES / f"{name}.gsclp").read_bytes()
        packets = gscl.packets_of(data)
        for at in range(len(data)):
            file = folder / f"{name}-{at}"
            file.write_bytes(data[:at] + bytes([data[at] ^ pick.randint(1, 255)]) + data[at + 1:])
            yield file
        for number, packet in enumerate(packets):
            for at in range(0, len(packet) - 2, 3):
                file = folder / f"{name}-{number}-{at}-sealed"
                changed = sealed(packet[:at] + bytes([packet[at] ^ pick.randint(1, 255)]) + packet[at + 1:-2])
                file.write_bytes(listed(packets[:number] + [changed] + packets[number + 1:]))
                yield file


if __name__ == "__main__":
    main()
