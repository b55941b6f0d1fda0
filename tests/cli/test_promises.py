"""The promises of host/PROMISES.md that the program alone can break: its options, its members of JSON, its exit codes.

A name that is missing here was promised, and a name that is not listed there is new: it gets a row with the version that brings it.
"""
import pathlib
import re

from images import png_bytes, scene
from promises import keys, listed, table
from tool import FAST, NO_OPENCL, ToolTest, main, read_json_lines

HOST = ("--device", "host")
HEADER = pathlib.Path(__file__).resolve().parents[2] / "host/include/gscl/version.h"


class Promises(ToolTest):
    def assert_listed(self, name, value):
        self.assertEqual(sorted(keys(value)), sorted(listed("Members of JSON")[name]), name)

    def test_options(self):
        commands = [line.split("\t")[0] for line in self.gscl("--help=commands").decode().splitlines()]
        has = {name: [line.split("\t")[0] for line in self.gscl(name, "--help=options").decode().splitlines()] for name in commands}
        promised = listed("Options")
        self.assertEqual(sorted(has), sorted(promised))
        for name in commands:
            with self.subTest(name):
                self.assertEqual(sorted(has[name]), sorted(promised[name]))

    def test_versions(self):
        """No row names a version that is still to come."""
        newest = tuple(int(re.search(rf"_{part} (\d+)", HEADER.read_text()).group(1)) for part in ("MAJOR", "MINOR"))
        for heading in ("Options", "Members of JSON", "Exit codes"):
            for row in table(heading):
                self.assertLessEqual(tuple(map(int, row[1].split("."))), newest, row)

    def test_reports_of_encodes(self):
        self.write_png("in.png", scene(40, 30, 4))
        self.assert_listed("encode --json", self.gscl_json("encode", "in.png", "-o", "in.gscl", *FAST, *HOST))
        self.assert_listed("encode --json --trace", self.gscl_json("encode", "in.png", "-o", "in.gscl", "--trace", *FAST, *HOST))
        self.gscl("encode", "in.png", "--out-dir", "out", "--jsonl", "lines", "--quiet", *FAST, *HOST)
        self.assert_listed("encode --jsonl", read_json_lines(self.path("lines").read_bytes())[0])

    def test_reports_of_files(self):
        self.encode(scene(40, 30), *HOST)
        self.write_png("in.png", scene(40, 30))
        self.assert_listed("info --json", self.gscl_json("info", "in.gscl", "--reference", "in.png"))
        self.assert_listed("compare --json", self.gscl_json("compare", "in.png", "in.png"))
        self.gscl("export", "in.gscl", "-o", "in.ply")
        self.assert_listed("pack --json", self.gscl_json("pack", "in.ply", "-o", "packed.gscl", *HOST))

    def test_reports_of_devices(self):
        self.assert_listed("devices --json", self.gscl_json("devices", env=NO_OPENCL))
        self.assert_listed("devices --check --json", self.gscl_json("devices", "--check", env=NO_OPENCL))

    def exit_code(self, *arguments):
        return self.start(*arguments).returncode

    def test_exit_codes(self):
        """test_interrupt.py has those of signals."""
        self.write("good.png", png_bytes(scene(16, 12)))
        self.write("bad.png", b"no picture")
        several = ("encode", "good.png", "bad.png", "--out-dir", "out", "--quiet", *FAST, *HOST)
        has = {"0": self.exit_code("help"), "1": self.exit_code("info", "bad.png"), "2": self.exit_code("encode"),
               "3": self.exit_code(*several)}
        self.assertEqual({code: int(code) for code in has}, has)
        self.assertEqual([row[0] for row in table("Exit codes")], [*has, "128 + n"])
        text = self.gscl("help").decode()
        self.assertIn("0 success, 1 failure, 2 wrong usage, 3 some of several images failed, 128 + n signal n", text)


if __name__ == "__main__":
    main()
