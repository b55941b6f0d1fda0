"""Images in and out: every kind of pixel and file goes through encode and decode."""
import struct
import unittest

from pictures import (Picture, exr_bytes, flat, max_difference, noise, png_bytes, png_palette_bytes, pnm_bytes, psnr,
                      read_png, read_pnm, scene, srgb_to_linear, tiff_bytes)
from tool import ToolTest, main

# What effort 0 reaches on scene(48, 40) with room to spare; a wrong channel order, alpha or bit depth gives far less.
GOOD = 27.0
ROOMY = ("--bpp", "6")


class RoundTrip(ToolTest):
    def test_all_kinds_of_png(self):
        for channels in (1, 2, 3, 4):
            for depth in (8, 16):
                with self.subTest(channels=channels, depth=depth):
                    picture = scene(48, 40, channels, depth)
                    self.encode(picture, *ROOMY)
                    decoded = self.decode()
                    self.assertEqual(decoded.kind(), picture.kind())
                    self.assertGreater(psnr(picture, decoded), GOOD)

    def test_odd_sizes(self):
        for width, height in ((1, 1), (1, 37), (41, 1), (2, 2), (31, 53), (97, 13)):
            with self.subTest(width=width, height=height):
                picture = scene(width, height)
                self.encode(picture, "--bytes", "2000")
                decoded = self.decode()
                self.assertEqual(decoded.kind(), picture.kind())
                self.assertGreater(psnr(picture, decoded), 15.0)

    def test_one_colour_is_exact(self):
        for colour in ((7,), (200, 100), (10, 128, 250), (90, 60, 30, 255)):
            with self.subTest(colour=colour):
                picture = flat(33, 20, colour)
                data = self.encode(picture, "--bpp", "8")
                self.assertLessEqual(len(data), 40)
                decoded = self.decode()
                self.assertEqual(decoded.kind(), picture.kind())
                self.assertLessEqual(max_difference(picture, decoded), 1)

    def test_grey_stays_grey_and_colour_stays_colour(self):
        grey_as_rgb = scene(32, 32, 1)
        grey_as_rgb = Picture(32, 32, 3, 8, [sample for sample in grey_as_rgb.samples for _ in range(3)])
        self.encode(grey_as_rgb, *ROOMY)
        decoded = self.decode()
        self.assertEqual(decoded.channels, 3)
        for at in range(0, len(decoded.samples), 3):
            self.assertEqual(len(set(decoded.samples[at:at + 3])), 1)

    def test_depth_option(self):
        self.encode(scene(48, 40, 3, 16), *ROOMY)
        deep, shallow = self.decode(), self.decode("--depth", "8")
        self.assertEqual((deep.depth, shallow.depth), (16, 8))
        for a, b in zip(deep.samples, shallow.samples):
            self.assertLessEqual(abs(a / 257 - b), 0.51)


class Alpha(ToolTest):
    def test_alpha_survives(self):
        for channels in (2, 4):
            with self.subTest(channels=channels):
                picture = scene(48, 40, channels)
                self.encode(picture, *ROOMY)
                decoded = self.decode()
                alpha = slice(channels - 1, None, channels)
                errors = [(a - b) ** 2 for a, b in zip(picture.samples[alpha], decoded.samples[alpha])]
                self.assertLess((sum(errors) / len(errors)) ** 0.5, 12)
                self.assertLess(max(decoded.samples[alpha][-8:]), 64)

    def test_colour_under_transparency_does_not_matter(self):
        visible = scene(32, 32, 4)
        hidden = Picture(32, 32, 4, 8, list(visible.samples))
        for at in range(0, len(hidden.samples), 4):
            if hidden.samples[at + 3] == 0:
                hidden.samples[at:at + 3] = 255, 0, 255
        self.assertNotEqual(hidden.samples, visible.samples)
        self.assertEqual(self.encode(visible, *ROOMY), self.encode(hidden, *ROOMY))

    def test_decoded_colours_are_straight(self):
        self.encode(flat(16, 16, (200, 100, 50, 128)))
        decoded = self.decode()
        for sample, wanted in zip(decoded.samples, (200, 100, 50, 128)):
            self.assertLessEqual(abs(sample - wanted), 2)

    def test_premultiplied_tiff_is_the_same_picture(self):
        straight = scene(32, 32, 4)
        multiplied = Picture(32, 32, 4, 8, [round(value) for value in straight.normal()])
        multiplied.samples[3::4] = straight.samples[3::4]
        self.write("straight.tif", tiff_bytes(straight, extra_samples=(2,)))
        self.write("multiplied.tif", tiff_bytes(multiplied, extra_samples=(1,)))
        self.write_png("straight.png", straight)
        self.assertIsNone(self.gscl_json("compare", "straight.png", "straight.tif")["psnr"])
        self.assertLess(self.gscl_json("compare", "straight.png", "multiplied.tif")["max_difference"], 0.51)


class Reading(ToolTest):
    def same(self, name, picture, tolerance=0.01):
        self.write_png("wanted.png", picture)
        self.assertLessEqual(self.gscl_json("compare", "wanted.png", name)["max_difference"], tolerance)

    def test_palettes_are_expanded(self):
        indices = [(x + y) % 3 for y in range(12) for x in range(12)]
        for palette in ([(255, 0, 0), (0, 128, 0), (9, 9, 200)], [(255, 0, 0, 255), (0, 128, 0, 128), (9, 9, 200, 0)]):
            with self.subTest(palette=palette):
                self.write("in.png", png_palette_bytes(12, 12, palette, indices))
                samples = [sample for index in indices for sample in palette[index]]
                self.same("in.png", Picture(12, 12, len(palette[0]), 8, samples))

    def test_pnm(self):
        for channels in (1, 3):
            for depth in (8, 16):
                with self.subTest(channels=channels, depth=depth):
                    picture = scene(20, 15, channels, depth)
                    self.write("in.pnm", pnm_bytes(picture))
                    self.same("in.pnm", picture)

    def test_tiff(self):
        for channels in (1, 2, 3, 4):
            for depth in (8, 16):
                with self.subTest(channels=channels, depth=depth):
                    picture = scene(20, 15, channels, depth)
                    self.write("in.tif", tiff_bytes(picture, extra_samples=(2,) if picture.has_alpha else ()))
                    self.same("in.tif", picture)

    def test_exr_is_linear_light(self):
        picture = scene(20, 15, 3)
        linear = [srgb_to_linear(sample / 255) for sample in picture.samples]
        self.write("in.exr", exr_bytes(20, 15, {"R": linear[0::3], "G": linear[1::3], "B": linear[2::3]}))
        self.same("in.exr", picture)

    def test_exr_alpha_is_premultiplied(self):
        picture = scene(20, 15, 4)
        planes = {"A": [sample / 255 for sample in picture.samples[3::4]]}
        for c, name in enumerate("RGB"):
            colours = zip(picture.samples[c::4], planes["A"])
            planes[name] = [srgb_to_linear(sample / 255) * alpha for sample, alpha in colours]
        self.write("in.exr", exr_bytes(20, 15, planes))
        self.same("in.exr", picture)

    def test_more_channels_than_four(self):
        picture = scene(20, 15, 3)
        planes = {name: [srgb_to_linear(s / 255) for s in picture.samples[c::3]] for c, name in enumerate("RGB")}
        self.write("in.exr", exr_bytes(20, 15, {**planes, "A": [1.0] * 300, "Z": [5.0] * 300}))
        opaque = [sample for at in range(0, 900, 3) for sample in picture.samples[at:at + 3] + [255]]
        self.same("in.exr", Picture(20, 15, 4, 8, opaque))

    def test_orientation_is_applied(self):
        picture = scene(20, 15, 3)
        rows = [picture.row(y) for y in range(15)]
        # 6: the picture's first row is the right-hand side of what is meant.
        turned = [rows[14 - x][3 * y + c] for y in range(20) for x in range(15) for c in range(3)]
        self.write("in.tif", tiff_bytes(picture, orientation=6))
        self.same("in.tif", Picture(15, 20, 3, 8, turned))

    def test_suffix_does_not_matter(self):
        picture = scene(20, 15, 3)
        self.write("in.jpg", png_bytes(picture))
        self.same("in.jpg", picture)
        self.write("in.png", tiff_bytes(picture))
        self.same("in.png", picture)

    def test_channels_without_meaning(self):
        self.write("cmyk.tif", tiff_bytes(scene(20, 15, 4), photometric=5))
        self.refused("cmyk.tif", "CMYK.*RGB", "encode", "cmyk.tif")
        self.write("five.tif", tiff_bytes(Picture(4, 4, 5, 8, [1] * 80), extra_samples=(0, 0)))
        self.refused("five.tif", "has the channels.*grey or RGB", "encode", "five.tif")


class Writing(ToolTest):
    def setUp(self):
        super().setUp()
        self.encode(scene(24, 18), *ROOMY)

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
        wanted = self.decode()
        self.gscl("decode", "in.gscl", "-o", "out.ppm")
        self.assertEqual(read_pnm(self.path("out.ppm").read_bytes()), wanted)
        self.encode(scene(24, 18, 1, 16), *ROOMY)
        wanted = self.decode()
        self.gscl("decode", "in.gscl", "-o", "out.pgm")
        self.assertEqual(read_pnm(self.path("out.pgm").read_bytes()), wanted)

    def test_alpha_in_tiff_and_exr(self):
        self.encode(scene(24, 18, 4), *ROOMY)
        self.decode()
        for suffix in ("tif", "exr"):
            with self.subTest(suffix=suffix):
                self.gscl("decode", "in.gscl", "-o", f"out.{suffix}")
                self.assertLess(self.gscl_json("compare", "in.png", f"out.{suffix}")["max_difference"], 0.8)

    def test_what_a_format_cannot_hold(self):
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

    def test_depth_means_nothing_for_exr(self):
        self.refused("decode", "--depth", "decode", "in.gscl", "-o", "out.exr", "--depth", "8", code=2)

    def test_module_is_loaded_only_when_needed(self):
        environment = {"LD_DEBUG": "files"}
        done = self.start("decode", "in.gscl", "-o", "out.png", env=environment)
        self.assertEqual(done.returncode, 0)
        self.assertNotIn(b"libOpenImageIO", done.stderr)
        done = self.start("decode", "in.gscl", "-o", "out.tif", env=environment)
        self.assertIn(b"libOpenImageIO", done.stderr)


if __name__ == "__main__":
    main()
