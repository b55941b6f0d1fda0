"""Encode and decode with every pixel type and image format."""
import struct
import unittest

from images import (Image, exr_bytes, flat, jpeg_bytes, max_difference, noise, png_bytes, png_palette_bytes, pnm_bytes,
                      psnr, read_png, read_pnm, scene, srgb_to_linear, tiff_bytes)
from tool import FAST, ToolTest, main

# dB; effort 0 exceeds it on scene(48, 40), while a wrong channel order, alpha or bit depth is far below.
MIN_PSNR = 27.0
HIGH_RATE = ("--bpp", "6")


class RoundTrip(ToolTest):
    def test_all_kinds_of_png(self):
        for channels in (1, 2, 3, 4):
            for depth in (8, 16):
                with self.subTest(channels=channels, depth=depth):
                    image = scene(48, 40, channels, depth)
                    self.encode(image, *HIGH_RATE)
                    decoded = self.decode()
                    self.assertEqual(decoded.kind(), image.kind())
                    self.assertGreater(psnr(image, decoded), MIN_PSNR)

    def test_odd_sizes(self):
        for width, height in ((1, 1), (1, 37), (41, 1), (2, 2), (31, 53), (97, 13)):
            with self.subTest(width=width, height=height):
                image = scene(width, height)
                self.encode(image, "--bytes", "2000")
                decoded = self.decode()
                self.assertEqual(decoded.kind(), image.kind())
                self.assertGreater(psnr(image, decoded), 15.0)

    def test_one_colour_is_exact(self):
        for colour in ((7,), (200, 100), (10, 128, 250), (90, 60, 30, 255)):
            with self.subTest(colour=colour):
                image = flat(33, 20, colour)
                data = self.encode(image, "--bpp", "8")
                self.assertLessEqual(len(data), 40)
                decoded = self.decode()
                self.assertEqual(decoded.kind(), image.kind())
                self.assertLessEqual(max_difference(image, decoded), 1)

    def test_grey_stays_grey_and_colour_stays_colour(self):
        grey_as_rgb = scene(32, 32, 1)
        grey_as_rgb = Image(32, 32, 3, 8, [sample for sample in grey_as_rgb.samples for _ in range(3)])
        self.encode(grey_as_rgb, *HIGH_RATE)
        decoded = self.decode()
        self.assertEqual(decoded.channels, 3)
        for at in range(0, len(decoded.samples), 3):
            self.assertEqual(len(set(decoded.samples[at:at + 3])), 1)

    def test_depth_option(self):
        self.encode(scene(48, 40, 3, 16), *HIGH_RATE)
        high, low = self.decode(), self.decode("--depth", "8")
        self.assertEqual((high.depth, low.depth), (16, 8))
        for a, b in zip(high.samples, low.samples):
            self.assertLessEqual(abs(a / 257 - b), 0.51)


class Alpha(ToolTest):
    def test_alpha_survives(self):
        for channels in (2, 4):
            with self.subTest(channels=channels):
                image = scene(48, 40, channels)
                self.encode(image, *HIGH_RATE)
                decoded = self.decode()
                alpha = slice(channels - 1, None, channels)
                errors = [(a - b) ** 2 for a, b in zip(image.samples[alpha], decoded.samples[alpha])]
                self.assertLess((sum(errors) / len(errors)) ** 0.5, 12)
                self.assertLess(max(decoded.samples[alpha][-8:]), 64)

    def test_colour_under_transparency_does_not_matter(self):
        visible = scene(32, 32, 4)
        hidden = Image(32, 32, 4, 8, list(visible.samples))
        for at in range(0, len(hidden.samples), 4):
            if hidden.samples[at + 3] == 0:
                hidden.samples[at:at + 3] = 255, 0, 255
        self.assertNotEqual(hidden.samples, visible.samples)
        self.assertEqual(self.encode(visible, *HIGH_RATE), self.encode(hidden, *HIGH_RATE))

    def test_decoded_colours_are_straight(self):
        self.encode(flat(16, 16, (200, 100, 50, 128)))
        decoded = self.decode()
        for sample, expected in zip(decoded.samples, (200, 100, 50, 128)):
            self.assertLessEqual(abs(sample - expected), 2)

    def test_premultiplied_tiff_is_the_same_image(self):
        straight = scene(32, 32, 4)
        multiplied = Image(32, 32, 4, 8, [round(value) for value in straight.normal()])
        multiplied.samples[3::4] = straight.samples[3::4]
        self.write("straight.tif", tiff_bytes(straight, extra_samples=(2,)))
        self.write("multiplied.tif", tiff_bytes(multiplied, extra_samples=(1,)))
        self.write_png("straight.png", straight)
        self.assertIsNone(self.gscl_json("compare", "straight.png", "straight.tif")["psnr"])
        self.assertLess(self.gscl_json("compare", "straight.png", "multiplied.tif")["max_difference"], 0.51)


class Reading(ToolTest):
    def same(self, name, image, tolerance=0.01):
        self.write_png("expected.png", image)
        self.assertLessEqual(self.gscl_json("compare", "expected.png", name)["max_difference"], tolerance)

    def test_palettes_are_expanded(self):
        indices = [(x + y) % 3 for y in range(12) for x in range(12)]
        for palette in ([(255, 0, 0), (0, 128, 0), (9, 9, 200)], [(255, 0, 0, 255), (0, 128, 0, 128), (9, 9, 200, 0)]):
            with self.subTest(palette=palette):
                self.write("in.png", png_palette_bytes(12, 12, palette, indices))
                samples = [sample for index in indices for sample in palette[index]]
                self.same("in.png", Image(12, 12, len(palette[0]), 8, samples))

    def test_pnm(self):
        for channels in (1, 3):
            for depth in (8, 16):
                with self.subTest(channels=channels, depth=depth):
                    image = scene(20, 15, channels, depth)
                    self.write("in.pnm", pnm_bytes(image))
                    self.same("in.pnm", image)

    def test_tiff(self):
        for channels in (1, 2, 3, 4):
            for depth in (8, 16):
                with self.subTest(channels=channels, depth=depth):
                    image = scene(20, 15, channels, depth)
                    self.write("in.tif", tiff_bytes(image, extra_samples=(2,) if image.has_alpha else ()))
                    self.same("in.tif", image)

    def test_exr_is_linear_light(self):
        image = scene(20, 15, 3)
        linear = [srgb_to_linear(sample / 255) for sample in image.samples]
        self.write("in.exr", exr_bytes(20, 15, {"R": linear[0::3], "G": linear[1::3], "B": linear[2::3]}))
        self.same("in.exr", image)

    def test_exr_alpha_is_premultiplied(self):
        image = scene(20, 15, 4)
        planes = {"A": [sample / 255 for sample in image.samples[3::4]]}
        for c, name in enumerate("RGB"):
            colours = zip(image.samples[c::4], planes["A"])
            planes[name] = [srgb_to_linear(sample / 255) * alpha for sample, alpha in colours]
        self.write("in.exr", exr_bytes(20, 15, planes))
        self.same("in.exr", image)

    def test_more_channels_than_four(self):
        image = scene(20, 15, 3)
        planes = {name: [srgb_to_linear(s / 255) for s in image.samples[c::3]] for c, name in enumerate("RGB")}
        self.write("in.exr", exr_bytes(20, 15, {**planes, "A": [1.0] * 300, "Z": [5.0] * 300}))
        opaque = [sample for at in range(0, 900, 3) for sample in image.samples[at:at + 3] + [255]]
        self.same("in.exr", Image(20, 15, 4, 8, opaque))

    def test_orientation_is_applied(self):
        image = scene(20, 15, 3)
        rows = [image.row(y) for y in range(15)]
        # Orientation 6: the first stored row is the right-hand side of the upright image.
        rotated = [rows[14 - x][3 * y + c] for y in range(20) for x in range(15) for c in range(3)]
        self.write("in.tif", tiff_bytes(image, orientation=6))
        self.same("in.tif", Image(15, 20, 3, 8, rotated))

    def test_suffix_does_not_matter(self):
        image = scene(20, 15, 3)
        self.write("in.jpg", png_bytes(image))
        self.same("in.jpg", image)
        self.write("in.png", tiff_bytes(image))
        self.same("in.png", image)

    def test_channels_without_meaning(self):
        self.write("cmyk.tif", tiff_bytes(scene(20, 15, 4), photometric=5))
        self.refused("cmyk.tif", "CMYK.*RGB", "encode", "cmyk.tif")
        self.write("five.tif", tiff_bytes(Image(4, 4, 5, 8, [1] * 80), extra_samples=(0, 0)))
        self.refused("five.tif", "has the channels.*grey or RGB", "encode", "five.tif")


class Writing(ToolTest):
    def setUp(self):
        super().setUp()
        self.encode(scene(24, 18), *HIGH_RATE)

    def test_tiff_exr_and_bmp(self):
        self.decode()
        for suffix, tolerance in (("tif", 0.01), ("exr", 0.51), ("bmp", 0.01), ("tga", 0.01), ("TIF", 0.01)):
            with self.subTest(suffix=suffix):
                self.gscl("decode", "in.gscl", "-o", f"out.{suffix}")
                difference = self.gscl_json("compare", "in.png", f"out.{suffix}")["max_difference"]
                self.assertLessEqual(difference, tolerance)

    def test_jpeg(self):
        self.decode()
        self.gscl("decode", "in.gscl", "-o", "out.jpg")
        self.assertEqual(self.path("out.jpg").read_bytes()[:3], b"\xff\xd8\xff")
        self.assertGreater(self.gscl_json("compare", "in.png", "out.jpg")["psnr"], 27)

    def test_ppm_and_pgm(self):
        expected = self.decode()
        self.gscl("decode", "in.gscl", "-o", "out.ppm")
        self.assertEqual(read_pnm(self.path("out.ppm").read_bytes()), expected)
        self.encode(scene(24, 18, 1, 16), *HIGH_RATE)
        expected = self.decode()
        self.gscl("decode", "in.gscl", "-o", "out.pgm")
        self.assertEqual(read_pnm(self.path("out.pgm").read_bytes()), expected)

    def test_alpha_in_tiff_and_exr(self):
        self.encode(scene(24, 18, 4), *HIGH_RATE)
        self.decode()
        for suffix in ("tif", "exr"):
            with self.subTest(suffix=suffix):
                self.gscl("decode", "in.gscl", "-o", f"out.{suffix}")
                self.assertLess(self.gscl_json("compare", "in.png", f"out.{suffix}")["max_difference"], 0.8)

    def test_refuses_images_that_a_format_cannot_hold(self):
        self.refused("out.pgm", ".pgm cannot hold a colour image", "decode", "in.gscl", "-o", "out.pgm")
        self.encode(scene(24, 18, 4))
        self.refused("out.jpg", ".jpg cannot hold.*alpha.*.png", "decode", "in.gscl", "-o", "out.jpg")
        self.encode(scene(24, 18, 3, 16))
        self.refused("out.jpg", ".jpg cannot hold.*16 bits.*--depth 8", "decode", "in.gscl", "-o", "out.jpg")
        self.gscl("decode", "in.gscl", "-o", "out.jpg", "--depth", "8")
        self.encode(scene(24, 18, 1))
        self.refused("out.ppm", ".ppm cannot hold a grey image", "decode", "in.gscl", "-o", "out.ppm")

    def test_unknown_suffix(self):
        for name in ("out.xyz", "out", ".png"):
            with self.subTest(name=name):
                self.refused("decode", "no image format.*\\.png", "decode", "in.gscl", "-o", name, code=2)

    def test_depth_does_not_apply_to_exr(self):
        self.refused("decode", "--depth", "decode", "in.gscl", "-o", "out.exr", "--depth", "8", code=2)

    def test_module_is_loaded_only_when_needed(self):
        environment = {"LD_DEBUG": "files"}
        for suffix in ("png", "jpg", "tif", "ppm"):
            done = self.start("decode", "in.gscl", "-o", f"out.{suffix}", env=environment)
            self.assertEqual(done.returncode, 0)
            self.assertFalse(b"libOpenImageIO" in done.stderr, suffix)
        done = self.start("decode", "in.gscl", "-o", "out.exr", env=environment)
        self.assertTrue(b"libOpenImageIO" in done.stderr)


def two_pages(reduced=False):
    """A TIFF whose second directory describes the pixels of the first once more, as a preview of them if `reduced`."""
    data = tiff_bytes(scene(40, 30))
    start = struct.unpack_from(">I", data, 4)[0]
    count = struct.unpack_from(">H", data, start)[0]
    entries = data[start + 2:start + 2 + 12 * count]
    if reduced:
        entries = struct.pack(">HHII", 254, 4, 1, 1) + entries
    second = struct.pack(">H", len(entries) // 12) + entries + bytes(4)
    return data[:-4] + struct.pack(">I", len(data)) + second


def gif_bytes(frames):
    """A GIF of one white pixel in each frame."""
    frame = b"\x21\xf9\x04\0\x0a\0\0\0" + b"\x2c" + struct.pack("<4HB", 0, 0, 1, 1, 0) + b"\x02\x02\x44\x01\0"
    return b"GIF89a" + struct.pack("<HHBBB", 1, 1, 0x80, 0, 0) + b"\xff\xff\xff\0\0\0" + frame * frames + b"\x3b"


class Losses(ToolTest):
    """Warnings of what an encode does not show of its input."""

    def warning(self, name, data, *arguments):
        """Encodes a file and returns what is printed besides the line of results."""
        self.write(name, data)
        done = self.start("encode", name, "-o", "out.gscl", *FAST, *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return "".join(line for line in done.stderr.decode().splitlines() if not line.startswith("out.gscl: "))

    def test_damaged_jpeg(self):
        data = jpeg_bytes(noise(64, 64))
        self.assertEqual(self.warning("in.jpg", data), "")
        at = data.index(b"\xff\xda") + 14 + 300
        damaged = data[:at] + b"\xff\xd3" + data[at + 2:]
        self.assertRegex(self.warning("in.jpg", damaged), "^gscl: in.jpg: warning: is damaged, and so may be .*: .")
        self.assertEqual(self.warning("in.jpg", damaged, "--quiet"), "")

    def test_further_images(self):
        message = "holds more than one image; only the first is read"
        animated = png_bytes(scene(20, 20), [(b"acTL", struct.pack(">II", 2, 0))])
        for name, data in (("in.tif", two_pages()), ("in.gif", gif_bytes(3)), ("in.png", animated)):
            with self.subTest(name=name):
                self.assertEqual(self.warning(name, data), f"gscl: {name}: warning: {message}")
                self.assertEqual(self.warning(name, data, "--quiet"), "")

    def test_single_images(self):
        still = png_bytes(scene(20, 20), [(b"acTL", struct.pack(">II", 1, 0))])
        for name, data in (("in.tif", tiff_bytes(scene(40, 30))), ("in.tif", two_pages(reduced=True)),
                           ("in.gif", gif_bytes(1)), ("in.png", still)):
            with self.subTest(name=name):
                self.assertEqual(self.warning(name, data), "")

    def test_clamped_samples(self):
        bright = [0.5] * 98 + [1.5, -0.1]
        half = [0.5] * 99 + [1.0]
        self.assertRegex(self.warning("in.exr", exr_bytes(10, 10, {"R": bright, "G": half, "B": half})),
                         "in.exr: warning: 2 samples lie outside 0..1 and are clamped")
        self.assertEqual(self.warning("in.exr", exr_bytes(10, 10, {"R": half, "G": half, "B": half})), "")
        half_clear = [0.25] * 100  # premultiplied: 0.25 of 0.25 is 1
        self.assertEqual(self.warning("in.exr", exr_bytes(10, 10, {c: half_clear for c in "RGBA"})), "")

    def test_tiff_without_bits_per_sample(self):
        """TIFF takes it for 1 bit; the reader of the pixels takes it for 8."""
        data = tiff_bytes(scene(40, 30, 1))
        entry = data.index(struct.pack(">HHI", 258, 3, 1))
        count_at = struct.unpack_from(">I", data, 4)[0]
        count = struct.unpack_from(">H", data, count_at)[0]
        bilevel = data[:count_at] + struct.pack(">H", count - 1) + data[count_at + 2:entry] + data[entry + 12:]
        self.write("in.tif", bilevel)
        self.refused("in.tif", "lacks the field BitsPerSample", "encode", "in.tif", "-o", "out.gscl", *FAST)
        with open(self.path("in.tif"), "rb") as pipe:
            self.refused("standard input", "lacks the field BitsPerSample", "encode", "-", "-o", "out.gscl", *FAST,
                         stdin=pipe)


if __name__ == "__main__":
    main()
