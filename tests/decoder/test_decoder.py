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
        self.assertEqual(self.numbers_after("i = 0..32:", 33), gscl.T)

    def test_levels(self):
        self.assertEqual(self.numbers_after("\n| levels |", 16), gscl.LEVELS)

    def test_check(self):
        self.assertEqual(gscl.crc16(b"123456789"), 0xD64E)
        self.assertIn("0xD64E", self.page)


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

    def test_refused(self):
        file = SET / "files" / "cut-half.gscl"
        done = self.start("--codes", file)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertRegex(done.stderr, rf"\Agscl_decoder: {re.escape(str(file))}: truncated: [^\n]+\n\Z")
        self.assertRegex(self.decoded("--partial", file), r"\A24x16, 20 splats, [1-9]\d? of them certain\n\Z")


if __name__ == "__main__":
    main()
