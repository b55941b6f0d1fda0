"""The decoder as a command, and the numbers that the page prints."""
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "cli")]

import gscl_decoder as gscl
from images import read_png
from tool import main

SET = HERE.parent / "conformance"


class Page(unittest.TestCase):
    def setUp(self):
        self.page = pathlib.Path(gscl.PAGE).read_text()

    def numbers_after(self, text, count):
        return [int(number) for number in re.findall(r"\b\d+\b", self.page.split(text)[1])[:count]]

    def test_powers(self):
        self.assertEqual(self.numbers_after("and for i = 0..31", 32), gscl.T[:32])

    def test_levels(self):
        self.assertEqual(self.numbers_after("\n| levels |", 16), gscl.LEVELS)

    def test_check(self):
        self.assertEqual(gscl.crc16(b"123456789"), 0xD64E)
        self.assertIn("0xD64E", self.page)

    def test_example(self):
        """The page has these lines about example.gscl."""
        data = (SET / "files" / "example.gscl").read_bytes()
        picture = gscl.decode(data)
        for line in (bytes_line(data), *splat_lines(picture), *pixel_lines(picture)):
            self.assertIn(f"\n{line}\n", self.page)


def bytes_line(data):
    return "    " + " | ".join(part.hex(" ").upper() for part in (data[:5], data[5:-2], data[-2:]))


def splat_lines(picture):
    for number, (splat, gaussian) in enumerate(zip(picture.splats, picture.gaussians())):
        x, y, s1, s2, theta, _, colour = gaussian[:7]
        across, along = max(splat.parts_x, splat.parts_y), (splat.x // splat.parts_x, splat.y // splat.parts_y)
        part = splat.x % splat.parts_x if splat.parts_x > 1 else splat.y % splat.parts_y
        cells = (number, splat.major, splat.aspect, f"{splat.angle} of {picture.angle_count(splat.aspect)}", f"{along[0]}, {along[1]}",
                 f"{part} of {across}", splat.luma, splat.co, splat.cg, f"{x:.4f}, {y:.4f}", f"{s1:.4f}, {s2:.4f}", f"{theta:.4f}",
                 ", ".join(f"{c:.4f}" for c in colour))
        yield "| " + " | ".join(map(str, cells)) + " |"


def pixel_lines(picture):
    places = ((0, 0), (3, 3), (6, 4), (8, 5), (11, 7))
    yield "| pixel (i, j) | " + " | ".join(f"{i}, {j}" for i, j in places) + " |"
    for name, pixels in (("values", picture.samples), ("samples", picture.integers)):
        form = "{:.4f}" if name == "values" else "{}"
        shown = [", ".join(form.format(v) for v in pixels((i, j, 1, 1))[0][0]) for i, j in places]
        yield f"| {name} | " + " | ".join(shown) + " |"


class Command(unittest.TestCase):
    def start(self, *arguments):
        command = [sys.executable, str(HERE / "gscl_decoder.py"), *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True)

    def decoded(self, *arguments):
        done = self.start(*arguments)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done.stdout

    def test_codes_and_hash(self):
        file = SET / "files" / "photograph.gscl"
        text = self.decoded("--codes", file)
        self.assertEqual(self.decoded("--hash", file).strip(), gscl.hash_of(text))
        self.assertEqual(text.count("\nsplat "), 20)
        self.assertEqual(self.decoded(file), "24x16, 20 splats, 20 of them certain\n")

    def test_picture(self):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder, "out.png")
            self.decoded("--bare", SET / "files" / "bare-photograph.gscl", out)
            self.assertEqual(read_png(out.read_bytes()), read_png((SET / "pictures" / "bare-photograph.png").read_bytes()))

    def test_packets(self):
        """A list, one of its packets as a file, and that one with a changed byte."""
        file = SET / "files" / "packets-2.gsclp"
        self.assertEqual(self.decoded(file), "48x32, 24 splats, 24 of them certain\n")
        packet = gscl.packets_of(file.read_bytes())[1]
        with tempfile.TemporaryDirectory() as folder:
            single = pathlib.Path(folder, "single.gsclp")
            single.write_bytes(packet)
            self.assertRegex(self.decoded("--codes", single), r"\nsplats 1\d\n")
            single.write_bytes(packet[:-1] + bytes([packet[-1] ^ 1]))
            self.assertIn("damaged: ", self.start(single).stderr)

    def test_elements(self):
        """The field of repair packets."""
        for a in range(1, 256):
            self.assertEqual(gscl.multiply(a, gscl.inverse(a)), 1)
        self.assertEqual(gscl.multiply(0x80, 2), 0x1D)

    def test_refused(self):
        file = SET / "files" / "cut-half.gscl"
        done = self.start("--codes", file)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertRegex(done.stderr, rf"\Agscl_decoder: {re.escape(str(file))}: truncated: [^\n]+\n\Z")
        self.assertRegex(self.decoded("--partial", file), r"\A24x16, 20 splats, [1-9]\d? of them certain\n\Z")


if __name__ == "__main__":
    main()
