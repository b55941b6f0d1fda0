"""The OpenImageIO plug-in, through oiiotool: reading, writing, attributes, bad files.

OIIO_LIBRARY_PATH names the folder of the plug-in, and USE_PLUGIN the program use_plugin.
"""
import array
import json
import os
import pathlib
import re
import subprocess
import unittest

from gscl_file import contained, header
from images import (Image, exr_bytes, jpeg_bytes, jpeg_exif, max_difference, png_bytes, png_icc, png_xmp, psnr, read_png,
                    scene)
from profiles import DISPLAY_P3, SRGB, exif_bytes, icc_rgb
from tool import FAST, TIMEOUT, ToolTest, main

MAKE, ORIENTATION = 0x010F, 0x0112
QUICK = ("--attrib", "gscl:effort", 0)
PACKET = (b"<?xpacket begin='' id=''?><x:xmpmeta xmlns:x='adobe:ns:meta/'><rdf:RDF "
          b"xmlns:rdf='http://www.w3.org/1999/02/22-rdf-syntax-ns#'><rdf:Description rdf:about='' "
          b"xmlns:photoshop='http://ns.adobe.com/photoshop/1.0/' photoshop:City='Utrecht'></rdf:Description></rdf:RDF></x:xmpmeta>")
CONFORMANCE = pathlib.Path(__file__).resolve().parent.parent / "conformance"


class PluginTest(ToolTest):
    def oiiotool(self, *arguments):
        done = self.start(*arguments, program="oiiotool")
        self.assertEqual(done.returncode, 0, (done.stderr + done.stdout).decode())
        return done.stdout.decode()

    def fails(self, message, *arguments):
        """oiiotool must fail with a message of the plug-in and leave no file."""
        before = self.files()
        done = self.start(*arguments, program="oiiotool")
        self.assertNotEqual(done.returncode, 0)
        self.assertRegex((done.stderr + done.stdout).decode(), message)
        self.assertEqual(self.files(), before)

    def write_by_plugin(self, image, *attributes, name="in"):
        self.write_png(f"{name}.png", image)
        self.oiiotool(f"{name}.png", *QUICK, *attributes, "-o", f"{name}.gscl")
        return self.path(f"{name}.gscl").stat().st_size

    def facts(self, name, *arguments):
        return self.oiiotool(*arguments, "--info", "-v", name)


class Reading(PluginTest):
    def test_same_pixels_as_the_tool(self):
        for channels, depth, names in ((2, 16, "Y, A"), (3, 8, "R, G, B")):
            self.encode(scene(61, 40, channels, depth))
            self.gscl("decode", "in.gscl", "-o", "tool.png", "--device", "host")
            facts = self.facts("in.gscl", "--iconfig", "oiio:UnassociatedAlpha", 1, "in.gscl", "-o", "plugin.tif")
            self.assertIn(b"max difference        0.00", self.gscl("compare", "tool.png", "plugin.tif"))
            self.assertIn(f"{channels} channel, uint{depth} gscl", facts)
            self.assertIn(f"channel list: {names}\n", facts)

    def test_images_of_the_tool(self):
        """What the tool decodes to, as OpenImageIO reads it, is what the plug-in decodes to."""
        for channels, suffixes in ((1, "png tif exr pgm tga"), (3, "png tif exr ppm bmp tga"), (4, "png tif exr tga")):
            self.encode(scene(61, 40, channels))
            self.oiiotool("in.gscl", "-o", "plugin.tif")
            for suffix in suffixes.split():
                with self.subTest(channels=channels, suffix=suffix):
                    self.gscl("decode", "in.gscl", "-o", f"out.{suffix}", "--device", "host")
                    curve = ("--colorconvert:unpremult=1", "linear", "sRGB") if suffix == "exr" else ()
                    self.oiiotool(f"out.{suffix}", *curve, "plugin.tif", "--fail", 0.009, "--diff")  # 2 of 255: both have rounded

    def test_premultiplied_by_default(self):
        self.encode(scene(40, 30, 4))
        self.oiiotool("in.gscl", "--ch", "R,G,B", "-o", "colours.png")
        straight = self.decode("--device", "host")
        colours = read_png(self.path("colours.png").read_bytes())
        for at in range(0, 40 * 30):
            alpha = straight.samples[4 * at + 3]
            expected = straight.samples[4 * at] * alpha / 255
            self.assertLess(abs(colours.samples[3 * at] - expected), 1.6)

    def test_hints(self):
        self.encode(scene(64, 48))
        for hints, size in ((("gscl:width", 32), "32 x   24"), (("gscl:height", 96), "128 x   96"),
                            (("gscl:width", 10, "--iconfig", "gscl:height", 10), "10 x   10")):
            self.assertIn(size, self.facts("in.gscl", "--iconfig", *hints))
        self.assertIn("float gscl", self.facts("in.gscl", "--iconfig", "gscl:samples", "float"))
        self.fails("gscl:samples cannot be 'int'; it takes", "--iconfig", "gscl:samples", "int", "in.gscl", "-o", "x.png")

    def test_limits(self):
        self.encode(scene(64, 48))
        for hint, message in (("gscl:max_pixels", "64 x 48 pixels, and at most 20"), ("gscl:max_work", "max_work is 20")):
            self.fails(message, "--iconfig", hint, 20, "in.gscl", "-o", "x.png")
        self.fails("16000 x 12000 pixels, which take 549 MiB, and limits:imagesize_MB is 100", "--oiioattrib",
                   "limits:imagesize_MB", 100, "--iconfig", "gscl:width", 16000, "in.gscl", "-o", "x.png")
        for hint in ("gscl:max_pixels", "gscl:max_work"):
            for value in (0, -5, 0.5, "many"):
                self.fails(f"{hint} cannot be {value}; it takes a number from 1", "--iconfig", hint, value, "in.gscl", "-o",
                           "x.png")

    def test_work_of_all_bands(self):
        """The limit of work is one of the whole picture, although rows are drawn in bands of 8 megapixels."""
        self.encode(scene(64, 48))
        size = ("--iconfig", "gscl:width", 6000) # four bands, of which each takes less than half of all
        work = self.gscl_json("info", "in.gscl")["work"] * (6000 / 64) ** 2
        self.facts("in.gscl", *size, "--iconfig", "gscl:max_work", f"{2 * work:e}")
        self.fails("drawing the picture takes about [0-9]+ evaluations; gscl:max_work is [0-9]+", *size, "--iconfig",
                   "gscl:max_work", f"{0.6 * work:e}", "--info", "in.gscl")
        # The work of a file that may be cut off is unknown: each band has its part of the limit.
        self.fails("max_work", *size, "--iconfig", "gscl:max_work", f"{0.1 * work:e}", "--iconfig", "gscl:partial", 1,
                   "in.gscl", "-o", "x.png")

    def test_short_exif(self):
        picture = header(16, 16, 0)
        for colour in (10, 20, 30):
            picture.raw(colour, 8)
        for exif in (b"", b"I", b"II*\0\x08\0\0"):
            self.write("in.gscl", contained(picture.finish(), after=bytes([0x80 | 32, len(exif)]) + exif))
            self.assertIn("16 x   16", self.facts("in.gscl"))

    def test_bad_and_partial_files(self):
        data = self.encode(scene(64, 48))
        self.write("cut.gscl", data[:len(data) // 2])
        self.fails("cut.gscl.*the file is incomplete", "cut.gscl", "-o", "x.png")
        self.oiiotool("--iconfig", "gscl:partial", 1, "cut.gscl", "-o", "part.png")
        self.gscl("decode", "cut.gscl", "-o", "tool.png", "--partial", "--device", "host")
        self.assertEqual(read_png(self.path("part.png").read_bytes()), read_png(self.path("tool.png").read_bytes()))
        self.write("flipped.gscl", data[:-9] + bytes([data[-9] ^ 1]) + data[-8:])
        self.write("text.gscl", b"not a picture")
        self.write("empty.gscl", b"")
        self.write("start.gscl", data[:6])
        for name, message in (("flipped", "damaged"), ("text", "not a gscl file"), ("empty", "not a gscl file"),
                              ("start", "incomplete")):
            self.fails(f"{name}.gscl.*{message}", f"{name}.gscl", "-o", "x.png")

    def test_metadata(self):
        profile = icc_rgb(DISPLAY_P3)
        self.write("in.png", png_bytes(scene(40, 30), [png_icc(profile), (b"eXIf", exif_bytes([(MAKE, "maker")])),
                                                      png_xmp(PACKET)]))
        self.gscl("encode", "in.png", "-o", "in.gscl", *FAST, "--quiet", "--keep-profile", "--metadata", "all")
        facts = self.facts("in.gscl")
        self.assertIn('Make: "maker"', facts)
        self.assertIn('City: "Utrecht"', facts)
        self.assertRegex(facts, r"CICP: 12, 13, 0, 1")
        self.assertNotIn("oiio:ColorSpace", facts)
        self.encode(scene(40, 30))
        self.assertIn('oiio:ColorSpace: "sRGB"', self.facts("in.gscl"))


class Writing(PluginTest):
    def test_targets(self):
        image = scene(96, 64)
        self.assertLessEqual(self.write_by_plugin(image, "--attrib", "gscl:bytes", 300), 300)
        self.assertLessEqual(self.write_by_plugin(image, "--attrib", "gscl:bpp", 0.4), 0.4 * 96 * 64 / 8)
        self.write_by_plugin(image, "--attrib", "gscl:psnr", 24)
        self.assertGreaterEqual(psnr(self.decode(), image), 23.9)
        self.write_by_plugin(image, "--attrib", "gscl:splats", 7)
        self.assertIn("7 splats", self.gscl("info", "in.gscl").decode())

    def test_same_bytes_as_the_tool(self):
        for channels in (1, 3):
            image = scene(48, 32, channels)
            expected = self.encode(image, "--bytes", 200, "--tune", "ssim", name="tool")
            self.write_by_plugin(image, "--attrib", "gscl:bytes", 200, "--attrib", "gscl:tune", "ssim")
            self.assertEqual(self.path("in.gscl").read_bytes(), expected)

    def test_quality(self):
        image = scene(96, 64)
        for quality, options in ((("--compression", "gscl:30"), ("-q", 30)), (("--quality", 45), ("-q", 45)),
                                 (("--compression", "gscl:0"), ("-q", 0)), (("--compression", "zip:9"), ())):
            with self.subTest(quality=quality):
                expected = self.encode(image, *options, name="tool")
                self.write_by_plugin(image, *quality)
                self.assertEqual(self.path("in.gscl").read_bytes(), expected)
        for quality, value in ((("--compression", "gscl:abc"), "abc"),
                               (("--compression", "gscl:"), ""), (("--compression", "gscl:101"), "101"),
                               (("--attrib:type=int", "CompressionQuality", -3), "-3"),
                               (("--attrib:type=int", "CompressionQuality", 101), "101")):
            with self.subTest(quality=quality):
                self.fails(f"a compression quality cannot be '{value}'; it takes 0 to 100", "in.png", *QUICK, *quality, "-o",
                           "x.gscl")

    def test_alpha_and_linear_light(self):
        image = scene(48, 32, 4)
        self.write_by_plugin(image, "--attrib", "gscl:bytes", 900)
        self.assertGreater(psnr(self.decode(), image), 30)
        self.oiiotool("in.png", "--colorconvert", "sRGB", "Linear", "-d", "float", "-o", "linear.exr")
        self.oiiotool("linear.exr", *QUICK, "--attrib", "gscl:bytes", 900, "-o", "linear.gscl")
        self.gscl("decode", "linear.gscl", "-o", "linear.png", "--depth", 8)
        self.assertGreater(psnr(read_png(self.path("linear.png").read_bytes()), image), 25)

    def test_gamma(self):
        """As the tool reads it, with LittleCMS."""
        for gamma in (100000, 55556, 45455):
            with self.subTest(gamma=gamma):
                self.write("in.png", png_bytes(scene(48, 32), [(b"gAMA", gamma.to_bytes(4, "big"))]))
                self.oiiotool("in.png", *QUICK, "--attrib", "gscl:bytes", 900, "-o", "in.gscl")
                self.gscl("decode", "in.gscl", "-o", "out.png", "--depth", 8)
                compared = self.gscl_json("compare", "in.png", "out.png")
                self.assertGreater(compared["psnr"], 27)

    def test_primaries(self):
        planes = {c: [0.25 + 0.5 * (i % 7) / 7 for i in range(80)] for c in "RGB"}
        self.write("in.exr", exr_bytes(10, 8, planes, primaries=SRGB))
        self.oiiotool("in.exr", *QUICK, "-o", "in.gscl")
        self.write("in.exr", exr_bytes(10, 8, planes, primaries=DISPLAY_P3))
        self.fails("other primaries than sRGB .attribute chromaticities.; convert them first", "in.exr", *QUICK, "-o", "x.gscl")

    def test_orientation_and_metadata(self):
        exif = exif_bytes([(MAKE, "maker"), (ORIENTATION, 6)])
        self.write("in.jpg", jpeg_bytes(scene(48, 32), [jpeg_exif(exif)]))
        self.oiiotool("in.jpg", *QUICK, "--attrib", "gscl:bytes", 900, "--attrib", "gscl:metadata", "exif", "-o", "in.gscl")
        facts = self.facts("in.gscl")
        self.assertRegex(facts, "32 x   48")
        self.assertIn('Make: "maker"', facts)
        self.assertIn("Orientation: 1", facts)
        self.gscl("decode", "in.gscl", "-o", "out.png")
        self.assertGreater(float(re.search(r"PSNR +([\d.]+)", self.gscl("compare", "in.jpg", "out.png").decode())[1]), 25)
        self.oiiotool("in.jpg", *QUICK, "-o", "none.gscl")
        self.assertNotIn("blocks:", self.gscl("info", "none.gscl").decode())

    def test_profile(self):
        self.write("in.png", png_bytes(scene(40, 30), [png_icc(icc_rgb(DISPLAY_P3, name="Wide"))]))
        self.oiiotool("in.png", *QUICK, "--attrib", "gscl:metadata", "all", "-o", "in.gscl")
        self.assertIn("ICCProfile:", self.facts("in.gscl"))
        self.assertRegex(self.gscl("info", "in.gscl").decode(), r"blocks: icc \(\d+ bytes\), exif \(\d+ bytes\)")
        for name, stored in (("sRGB built-in", False), ("sRGB-elle-V2-g10.icc", True)):
            self.write("srgb.png", png_bytes(scene(40, 30), [png_icc(icc_rgb(DISPLAY_P3, name=name))]))
            self.oiiotool("srgb.png", *QUICK, "-o", "srgb.gscl")
            self.assertEqual("blocks: icc" in self.gscl("info", "srgb.gscl").decode(), stored)

    def test_code_points(self):
        self.write_png("in.png", scene(32, 24))
        attribute = ("in.png", *QUICK, "--attrib:type=int[4]", "CICP")
        self.oiiotool(*attribute, "9,16,0,1", "-o", "in.gscl")
        self.assertIn("CICP: 9, 16, 0, 1", self.facts("in.gscl"))
        for points in ("256,13,0,1", "1,-1,0,1", "9,16,9,1", "9,16,0,0"):
            with self.subTest(points=points):
                self.fails(f"CICP cannot be {points.replace(',', ', ')}; it takes primaries and transfer from 0 to 255, "
                           "matrix 0 .RGB. and range 1 .full.", *attribute, points, "-o", "x.gscl")

    def test_refused(self):
        self.write_png("in.png", scene(32, 24))
        for attributes, message in (
                (("gscl:bytes", 9), "a budget of 9 bytes is too small"),
                (("gscl:bpp", -1), "gscl:bpp cannot be -1; it takes a number from 0.0001 to 64"),
                (("gscl:tune", "best"), "gscl:tune cannot be 'best'; it takes auto, psnr, ssim or visual"),
                (("gscl:effort", 10), "gscl:effort cannot be 10; it takes 0 to 9"),
                (("gscl:metadata", "some"), "gscl:metadata cannot be 'some'"),
                (("gscl:bpp", 1, "--attrib", "gscl:psnr", 30), "exclude each other"),
                (("gscl:bpp", 1, "--attrib", "gscl:preset", "small"), "exclude each other"),
                (("gscl:preset", "large"), "gscl:preset cannot be 'large'; it takes one of tiny, preview, small, good"),
                (("gscl:device", "no such device"), "no device matches")):
            with self.subTest(attributes=attributes):
                self.fails(message, "in.png", *QUICK, "--attrib", *attributes, "-o", "x.gscl")
        self.fails("cannot be written: No such file", "in.png", *QUICK, "-o", "missing/x.gscl")

    def test_links_and_modes(self):
        """A file behind symbolic links is replaced, not the link, and keeps its mode."""
        (self.folder / "folder").mkdir()
        self.write("folder/old.gscl", b"old")
        self.path("folder/old.gscl").chmod(0o640)
        for link, target in (("folder/second.gscl", "old.gscl"), ("first.gscl", "folder/second.gscl"),
                             ("dangling.gscl", "folder/new.gscl"), ("circle.gscl", "circle.gscl")):
            self.path(link).symlink_to(target)
        done = self.start("write", "first.gscl", "dangling.gscl", program=os.environ["USE_PLUGIN"])
        self.assertEqual(done.returncode, 0, done.stdout)
        for name in ("first.gscl", "folder/second.gscl", "dangling.gscl"):
            self.assertTrue(self.path(name).is_symlink(), name)
        self.assertEqual(self.path("folder/old.gscl").read_bytes()[:4], b"\xC7gsc")
        self.assertEqual(self.path("folder/old.gscl").stat().st_mode & 0o777, 0o640)
        self.assertEqual(self.path("folder/new.gscl").read_bytes(), self.path("folder/old.gscl").read_bytes())
        before = self.files()
        done = self.start("write", "circle.gscl", program=os.environ["USE_PLUGIN"])
        self.assertEqual(done.returncode, 1)
        self.assertIn(b'"circle.gscl" cannot be written: Too many levels of symbolic links', done.stdout)
        self.assertEqual(self.files(), before)
        self.assertTrue(self.path("circle.gscl").is_symlink())


class Tool(ToolTest):
    def test_the_tool_does_not_read_through_the_plugin(self):
        self.encode(scene(32, 24))
        message = "is a gscl file, not an image; 'gscl decode' makes an image of it"
        self.refused("in.gscl", message, "encode", "in.gscl", "-o", "x.gscl")
        self.refused("in.gscl", message, "compare", "in.image", "in.gscl")
        self.refused("standard input", message, "encode", "-", "-o", "x.gscl", input=self.path("in.gscl").read_bytes())


class Programs(ToolTest):
    def test_use_plugin(self):
        self.encode(scene(300, 200))
        done = subprocess.run([os.environ["USE_PLUGIN"], "in.gscl"], cwd=self.folder, capture_output=True, timeout=TIMEOUT)
        self.assertEqual(done.returncode, 0, (done.stdout + done.stderr).decode())

    def test_conformance(self):
        """The files of the conformance set give the pictures that they should, within 1/255, or are refused."""
        index = [entry for entry in json.loads((CONFORMANCE / "index.json").read_text())
                 if not entry["bare"] and "packets" not in entry]
        files = [CONFORMANCE / "files" / (entry["file"] + ".gscl") for entry in index]
        done = subprocess.run([os.environ["USE_PLUGIN"], self.folder, *files], capture_output=True, timeout=TIMEOUT, text=True)
        for number, (entry, line) in enumerate(zip(index, done.stdout.splitlines(), strict=True)):
            with self.subTest(file=entry["file"]):
                self.assertEqual("refused" if line == "refused" else "valid",
                                 "valid" if entry["result"] == "valid" else "refused")
                if "picture" in entry:
                    width, height, channels, depth = map(int, line.split())
                    samples = array.array("B" if depth == 8 else "H", self.path(f"{number}.raw").read_bytes()).tolist()
                    expected = read_png((CONFORMANCE / "pictures" / entry["picture"]).read_bytes())
                    image = Image(width, height, channels, depth, samples)
                    self.assertLessEqual(max_difference(image, expected), 1.0001)


if __name__ == "__main__":
    main()
