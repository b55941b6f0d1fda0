"""gscl files on the desktop: the gdk-pixbuf loader, thumbnails by gdk-pixbuf and by Tumbler, ImageMagick.

PIXBUF_LOADER is the loader's module, QUERY_LOADERS the program that lists loaders, USE_LOADER the program use_loader.
"""
import base64
import json
import os
import pathlib
import shutil
import subprocess
import unittest
import zlib

from gscl_file import contained, header
from images import (Image, jpeg_bytes, jpeg_exif, jpeg_icc, max_difference, png_bytes, png_icc, png_parts, psnr, read_png,
                    scene)
from profiles import ORIENTATION, exif_bytes, icc_rgb
from tool import FAST, GSCL, ToolTest, main

HERE = pathlib.Path(__file__).resolve().parent
CONFORMANCE = HERE.parent / "conformance"
HOST = HERE.parent.parent / "host"
ADOBE = ((0.3127, 0.3290), (0.640, 0.330), (0.210, 0.710), (0.150, 0.060))


def needs(*programs):
    missing = [program for program in programs if not shutil.which(program)]
    return unittest.skipIf(missing, f"needs {' '.join(missing)}")


def as_rgb(image):
    """The image as a pixbuf has it: 8 bits, RGB or RGBA."""
    samples = []
    for at in range(0, len(image.samples), image.channels):
        pixel = [sample * 255 / image.peak for sample in image.samples[at:at + image.channels]]
        samples += pixel if image.channels >= 3 else [pixel[0]] * 3 + pixel[1:]
    return Image(image.width, image.height, 4 if image.has_alpha else 3, 8, samples)


class DesktopTest(ToolTest):
    """A desktop of its own: the media type and the loader are those of this tree."""

    def setUp(self):
        super().setUp()
        data, cache = self.path("data"), self.path("loaders.cache")
        (data / "mime/packages").mkdir(parents=True)
        (data / "thumbnailers").mkdir()
        shutil.copy(HOST / "data/gscl.xml", data / "mime/packages")
        shutil.copy(os.environ["THUMBNAILER"], data / "thumbnailers")
        self.env = {"XDG_DATA_HOME": str(data), "XDG_CACHE_HOME": str(self.path("cache")),
                    "GDK_PIXBUF_MODULE_FILE": str(cache), "HOME": str(self.folder)}
        subprocess.run(["update-mime-database", data / "mime"], check=True, capture_output=True,
                       env={**os.environ, **self.env})
        with open(cache, "wb") as file:
            subprocess.run([os.environ["QUERY_LOADERS"], os.environ["PIXBUF_LOADER"]], check=True, stdout=file)

    def load(self, *files, part=1 << 20, size=(0, 0)):
        """Feeds files to the loader.  Returns for each its image or None, the numbers of signals, and the outcome."""
        done = self.start("load", part, *size, ".", *files, program=os.environ["USE_LOADER"], env=self.env)
        self.assertEqual(done.returncode, 0, done.stderr)
        results = []
        for number, line in enumerate(done.stdout.decode().splitlines()):
            *figures, outcome = line.split(" ", 6)
            width, height, channels, *signals = map(int, figures)
            image = None
            if width:
                image = Image(width, height, channels, 8, list(self.path(f"{number}.raw").read_bytes()))
            results.append((image, signals, outcome))
        self.assertEqual(len(results), len(files))
        return results

    def drawn(self, *arguments):
        self.gscl("decode", "in.gscl", "-o", "tool.png", "--device", "host", *arguments)
        return read_png(self.path("tool.png").read_bytes())


class Loader(DesktopTest):
    def test_whole_and_in_parts(self):
        self.encode(scene(90, 60))
        expected = self.drawn()
        (image, (prepared, updated, _), outcome), = self.load("in.gscl")
        self.assertEqual((image, prepared, updated, outcome), (expected, 1, 1, "ok"))
        (image, (prepared, updated, _), outcome), = self.load("in.gscl", part=10)
        self.assertEqual((image, prepared, outcome), (expected, 1, "ok"))
        self.assertGreater(updated, 2)

    def test_drawn_at_the_size_asked_for(self):
        self.encode(scene(90, 60))
        for size in ((30, 20), (200, 10)):
            (image, _, outcome), = self.load("in.gscl", size=size)
            self.assertEqual((image, outcome), (self.drawn("--size", "%dx%d" % size), "ok"))

    def test_cut_off(self):
        data = self.encode(scene(90, 60))
        self.write("in.gscl", data[:150])
        (image, _, outcome), = self.load("in.gscl", part=100)
        self.assertEqual(outcome, "gscl: the file is incomplete: 150 bytes are there and more are needed")
        self.assertEqual(image, self.drawn("--partial"))

    def test_bad_files(self):
        data = self.encode(scene(90, 60))
        files = {"empty": b"", "text": b"not a picture", "start": data[:7], "magic": data[:3]}
        for name, content in files.items():
            self.write(name, content)
        for part in (1 << 20, 1):
            outcomes = [outcome for image, _, outcome in self.load(*files, part=part)]
            self.assertEqual(outcomes[1:], ["gscl: not a gscl file", "gscl: the file is incomplete", "gscl: not a gscl file"])
            self.assertNotEqual(outcomes[0], "ok")

    def test_limits(self):
        """A file of a few bytes that describes 16384 x 16384 pixels is refused in full and drawn small."""
        picture = header(16384, 16384, 0)
        for colour in (10, 20, 30):
            picture.raw(colour, 8)
        huge = self.write("huge.gscl", contained(picture.finish()))
        (image, _, outcome), = self.load(huge)
        self.assertIsNone(image)
        self.assertEqual(outcome, "gscl: a picture of 16384 x 16384 pixels is too large; at most 67108864 pixels are drawn")
        (image, _, outcome), = self.load(huge, size=(16, 16))
        self.assertEqual((image.samples, outcome), ([10, 20, 30] * 256, "ok"))

    def test_profile(self):
        self.write("in.png", png_bytes(scene(40, 30), [png_icc(icc_rgb(ADOBE, 1.7))]))
        self.gscl("encode", "in.png", "-o", "in.gscl", *FAST, "--quiet", "--keep-profile")
        (_, (_, _, profile), outcome), = self.load("in.gscl")
        self.assertEqual(outcome, "ok")
        self.assertGreater(profile, 500)

    def test_code_points_become_a_profile(self):
        """gdk-pixbuf knows profiles only.  HDR has none."""
        for points, least, most in ((b"\x0c\x0d", 500, 3000), (b"\x09\x10", 0, 0)):
            self.write("in.png", png_bytes(scene(40, 30), [(b"cICP", points + b"\0\1")]))
            self.gscl("encode", "in.png", "-o", "in.gscl", *FAST, "--quiet", "--keep-profile")
            (_, (_, _, profile), outcome), = self.load("in.gscl")
            self.assertEqual(outcome, "ok")
            self.assertTrue(least <= profile <= most, profile)

    def test_conformance(self):
        index = [entry for entry in json.loads((CONFORMANCE / "index.json").read_text())
                 if not entry["bare"] and "packets" not in entry]
        loaded = self.load(*[CONFORMANCE / "files" / (entry["file"] + ".gscl") for entry in index])
        for entry, (image, _, outcome) in zip(index, loaded, strict=True):
            with self.subTest(file=entry["file"]):
                if entry["result"] != "valid":
                    self.assertRegex(outcome, "^gscl: ")
                elif "picture" in entry:
                    expected = read_png((CONFORMANCE / "pictures" / entry["picture"]).read_bytes())
                    self.assertEqual(outcome, "ok")
                    self.assertLess(max_difference(image, as_rgb(expected)), 1.51 if expected.depth == 16 else 1.01)

    def test_save(self):
        def save(*arguments):
            done = self.start("save", "out.gscl", *arguments, program=os.environ["USE_LOADER"], env=self.env)
            return done.stdout.decode().strip()
        self.assertEqual(save(), "ok")
        for option in ("bytes=100", "psnr=30", "tune=visual", "preset=tiny"):
            self.assertEqual(save(option), "ok")
        self.gscl("decode", "out.gscl", "-o", "out.png")
        self.assertEqual(read_png(self.path("out.png").read_bytes()).samples[:3], [0x30, 0x60, 0xC0])
        self.assertRegex(save("bytes=2"), "gscl: a budget of 2 bytes is too small")
        for option in ("bytes=many", "bytes=inf", "effort=10", "effort=1e300", "effort=inf", "effort=nan", "effort=2.5",
                       "effort=-1", "tune=best", "preset=large", "quality=101", "qualities=3"):
            key, value = option.split("=")
            self.assertRegex(save(option), f"gscl: the option {key} cannot be '{value}'; there are")


    def test_colours_and_orientation_are_kept(self):
        """Of a file of another format that a program opens and saves as gscl."""
        profile = icc_rgb(ADOBE, 1.7)
        exif = exif_bytes([(ORIENTATION, 6)])
        self.write("in.jpg", jpeg_bytes(scene(64, 40), [jpeg_exif(exif), *jpeg_icc(profile)]))
        done = self.start("convert", "in.jpg", "out.gscl", program=os.environ["USE_LOADER"], env=self.env)
        self.assertEqual(done.stdout.decode().strip(), "ok")
        self.gscl("decode", "out.gscl", "-o", "out.png")
        data = self.path("out.png").read_bytes()
        self.assertEqual((read_png(data).width, read_png(data).height), (40, 64))
        self.assertEqual(zlib.decompress(png_parts(data)[b"iCCP"].split(b"\0\0", 1)[1]), profile)

    def test_profile_option(self):
        def save(profile):
            text = base64.b64encode(profile).decode()
            done = self.start("save", "out.gscl", f"icc-profile={text}", program=os.environ["USE_LOADER"], env=self.env)
            return done.stdout.decode().strip()
        self.assertEqual(save(icc_rgb(ADOBE, 1.7)), "ok")
        self.gscl("decode", "out.gscl", "-o", "out.png")
        self.assertIn(b"iCCP", png_parts(self.path("out.png").read_bytes()))
        self.assertRegex(save(b""), "gscl: the option icc-profile cannot be ''")


class Thumbnails(DesktopTest):
    def test_gdk_pixbuf_thumbnailer(self):
        self.encode(scene(300, 200))
        done = self.start("-s", 64, "in.gscl", "thumb.png", program="gdk-pixbuf-thumbnailer", env=self.env)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(read_png(self.path("thumb.png").read_bytes()), self.drawn("--size", "64x43"))

    def test_entry(self):
        text = pathlib.Path(os.environ["THUMBNAILER"]).read_text()
        self.assertIn("Exec=gdk-pixbuf-thumbnailer -s %s %u %o\n", text)
        self.assertIn("MimeType=image/x-gscl;\n", text)

    @needs("dbus-run-session", "gdbus")
    @unittest.skipUnless(os.path.exists("/usr/share/dbus-1/services/org.xfce.Tumbler.Thumbnailer1.service"), "needs tumbler")
    def test_tumbler(self):
        """The thumbnailer of Xfce and others writes a thumbnail into the cache that file managers share."""
        self.encode(scene(300, 200))
        service = ("gdbus", "call", "--session", "--dest", "org.freedesktop.thumbnails.Thumbnailer1", "--object-path",
                   "/org/freedesktop/thumbnails/Thumbnailer1", "--method")
        queue = [*service, "org.freedesktop.thumbnails.Thumbnailer1.Queue", f"['{self.path('in.gscl').as_uri()}']",
                 "['image/x-gscl']", "normal", "default", "0"]
        thumbnails = self.path("cache/thumbnails/normal")
        # The session ends when its program does: it waits until the thumbnail is whole.
        wait = f'"$@" && until grep -qs IEND "{thumbnails}"/*.png; do sleep 0.2; done'
        done = self.start("--", "sh", "-c", wait, "wait", *queue, program="dbus-run-session", env=self.env)
        files = list(thumbnails.glob("*.png"))
        self.assertEqual(len(files), 1, done.stderr)
        image = read_png(files[0].read_bytes())
        self.assertEqual((image.width, image.height), (128, 85))
        opaque = [sample for at, sample in enumerate(image.samples) if image.channels == 3 or at % 4 < 3]
        self.assertGreater(psnr(Image(128, 85, 3, 8, opaque), self.drawn("--size", "128x85")), 50)


class Caches(DesktopTest):
    """host/desktop/update_caches.sh, for an installation in a folder of its own."""

    def update(self, query):
        (self.folder / "loaders").mkdir(exist_ok=True)
        shutil.copy(os.environ["PIXBUF_LOADER"], self.folder / "loaders")
        return self.start(HOST / "desktop/update_caches.sh", query, self.path("loaders"), self.path("no such folder"),
                          program="sh", env={**self.env, "MESON_INSTALL_PREFIX": str(self.path("prefix"))})

    def setUp(self):
        super().setUp()
        (self.path("prefix") / "share/mime/packages").mkdir(parents=True)
        self.write("loaders.cache", b"old")

    def test_lists_the_loader(self):
        done = self.update(os.environ["QUERY_LOADERS"])
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(b"image/x-gscl", self.path("loaders.cache").read_bytes())
        self.assertFalse(self.path("loaders.cache.new").exists())

    def test_keeps_the_old_list_when_listing_fails(self):
        self.write("query", b"#!/bin/sh\necho half of the list\nexit 1\n")
        self.path("query").chmod(0o755)
        self.assertNotEqual(self.update(self.path("query")).returncode, 0)
        self.assertEqual(self.path("loaders.cache").read_bytes(), b"old")
        self.assertFalse(self.path("loaders.cache.new").exists())


class ImageMagick(DesktopTest):
    @needs("convert")
    def test_delegates(self):
        """The delegates of host/desktop/delegates.xml, in a folder that MAGICK_CONFIGURE_PATH names."""
        (self.folder / "bin").mkdir()
        (self.folder / "bin/gscl").symlink_to(GSCL)
        env = {"PATH": f"{self.folder}/bin:{os.environ['PATH']}", "MAGICK_CONFIGURE_PATH": str(self.folder)}
        shutil.copy(HOST / "desktop/delegates.xml", self.folder)
        self.encode(scene(90, 60))
        done = self.start("in.gscl", "out.png", program="convert", env=env)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(read_png(self.path("out.png").read_bytes()), self.drawn())
        done = self.start("out.png", "back.gscl", program="convert", env=env)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(b"90 x 60 RGB", self.gscl("info", "back.gscl"))
        self.write("cut.gscl", self.path("in.gscl").read_bytes()[:100])
        done = self.start("cut.gscl", "cut.png", program="convert", env=env)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn(b"the file is incomplete: 100 bytes are there", done.stderr)


if __name__ == "__main__":
    main()
