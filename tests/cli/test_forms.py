"""The forms of gscl files: bare and as text; and what info says of blocks."""
import base64

from gscl_file import contained
from images import scene
from tool import FAST, ToolTest, main

SPLATS = ("--splats", "20")


class Forms(ToolTest):
    def setUp(self):
        super().setUp()
        self.file = self.encode(scene(40, 30), *SPLATS)

    def test_bare(self):
        self.gscl("encode", "in.image", "-o", "bare.gscl", "--bare", *SPLATS, *FAST)
        bare = self.path("bare.gscl").read_bytes()
        self.assertEqual(bare, self.file[5:-2])
        self.assertEqual(contained(bare), self.file)
        whole = self.decode()
        self.assertEqual(self.decode("--bare", name="bare"), whole)
        info = self.gscl_json("info", "bare.gscl", "--bare")
        self.assertEqual(info["bytes"], len(bare))
        self.assertEqual(info["effect_uses"], self.gscl_json("info", "in.gscl")["effect_uses"])
        self.assertNotIn("container", [stream["name"] for stream in info["streams"]])
        self.assertAlmostEqual(sum(stream["bytes"] for stream in info["streams"]), len(bare), places=3)
        self.gscl("info", "bare.gscl", "--bare", "--reference", "in.image")
        self.gscl("draw", "in.gscl", "-o", "whole.png")
        self.gscl("draw", "bare.gscl", "--bare", "-o", "drawn.png")
        self.assertEqual(self.path("drawn.png").read_bytes(), self.path("whole.png").read_bytes())

    def test_budget_counts_the_form(self):
        for bare in ((), ("--bare",)):
            with self.subTest(bare=bare):
                self.gscl("encode", "in.image", "-o", "out.gscl", "--bytes", "150", *bare, *FAST)
                self.assertIn(self.path("out.gscl").stat().st_size, range(140, 151))

    def test_forms_are_not_guessed(self):
        self.write("bare.gscl", self.file[5:-2])
        for command in (("info", "bare.gscl"), ("decode", "bare.gscl", "-o", "out.png"), ("draw", "bare.gscl", "-o", "out.png")):
            with self.subTest(command=command):
                self.refused("bare.gscl", "not a gscl file", *command)
        self.refused("bare.gscl", "does not occur in base64 ", "info", "bare.gscl", "--base64")

    def test_base64(self):
        expected = base64.urlsafe_b64encode(self.file).rstrip(b"=") + b"\n"
        options = ("--quiet", "--base64", *SPLATS, *FAST)
        self.assertEqual(self.gscl("encode", "in.image", *options), expected)
        self.gscl("encode", "in.image", "-o", "text.gscl", *options)
        self.assertEqual(self.path("text.gscl").read_bytes(), expected)
        self.gscl("encode", "in.image", "--out-dir", ".", *options)
        self.assertEqual(self.path("in.b64").read_bytes(), expected)
        whole = self.decode()
        self.assertEqual(self.decode("--base64", name="text"), whole)
        self.assertRegex(expected, b"[-_]")
        padded = base64.encodebytes(self.file)
        for text in (padded, padded.replace(b"+", b"-").replace(b"/", b"_"), padded.replace(b"=", b"")):
            self.write("text.gscl", b"\r\n " + text + b"\t\n")
            self.assertEqual(self.decode("--base64", name="text"), whole)
        self.assertEqual(self.gscl_json("info", "-", "--base64", input=expected)["bytes"], len(self.file))

    def test_lines_of_several_images(self):
        self.write("other.image", self.path("in.image").read_bytes())
        lines = self.gscl("encode", "in.image", "other.image", "--quiet", "--base64", "--bare", *SPLATS, *FAST).splitlines()
        self.assertEqual(len(lines), 2)
        self.assertEqual(lines[0], lines[1])
        self.assertEqual(base64.urlsafe_b64decode(lines[0] + b"=="), self.file[5:-2])

    def test_lengths_of_base64(self):
        """Every remainder of the size by three, and every value of six bits."""
        values = bytes(range(256))
        for size in range(254, 257):
            padded = base64.urlsafe_b64encode(values[:size])
            for text in (padded, padded.rstrip(b"=")):
                with self.subTest(text=text[-4:]):
                    self.write("text.gscl", text)
                    self.refused("text.gscl", "not a gscl file", "info", "text.gscl", "--base64")

    def test_bad_base64(self):
        text = base64.urlsafe_b64encode(self.file).rstrip(b"=")
        for name, data, message in (("character", text[:9] + b"*" + text[10:], "does not occur in base64 "),
                                    ("zero byte", text[:9] + b"\0" + text[10:], "does not occur in base64 "),
                                    ("padding inside", text[:9] + b"=" + text[10:], "does not occur in base64 "),
                                    ("one character", b"A", "ends within a byte"), ("bits left", b"AB", "ends within a byte"),
                                    ("nothing", b"", "not a gscl file"), ("spaces", b" \n", "not a gscl file")):
            with self.subTest(name=name):
                self.write("text.gscl", data)
                self.refused("text.gscl", message, "decode", "text.gscl", "--base64", "-o", "out.png")

    def test_json_and_text_exclude_each_other(self):
        self.refused("encode", "--json and --base64", "encode", "in.image", "--json", "--base64", *FAST, code=2)

    def test_blocks_are_shown(self):
        before, after = b"\x00\x02\x01\x0d\x81\x05abcde", b"\xa1\x03xyz"
        self.write("blocks.gscl", contained(self.file[5:-2], before=before, after=after))
        info = self.gscl_json("info", "blocks.gscl")
        self.assertEqual(info["blocks"], [{"name": "colour-space", "bytes": 2}, {"name": "icc", "bytes": 5},
                                          {"name": "xmp", "bytes": 3}])
        streams = {stream["name"]: stream["bytes"] for stream in info["streams"]}
        self.assertEqual((streams["container"], streams["blocks"]), (7, len(before) + len(after) + 7))
        text = self.gscl("info", "blocks.gscl").decode()
        self.assertIn("\nblocks: colour-space (2 bytes), icc (5 bytes), xmp (3 bytes)\n", text)
        self.assertNotIn("blocks:", self.gscl("info", "in.gscl").decode())
        # The effects cost the same bits, whatever surrounds the picture.
        self.assertEqual(info["effect_uses"], self.gscl_json("info", "in.gscl")["effect_uses"])


if __name__ == "__main__":
    main()
