"""Colour profiles and other descriptions of colours: pixels are converted to sRGB, and never change without a word."""
import re
import struct
import time
import unittest

from gscl_file import COLOUR_SPACE as COLOUR_BLOCK
from gscl_file import ICC, block, contained
from images import (AVIF_IMAGE, Image, avif_bytes, blocks, exr_bytes, flat, jpeg_bytes, jpeg_exif, jpeg_icc,
                    metadata_of, png_bytes, png_icc, png_parts, read_png, scene, tiff_bytes, webp_bytes)
from profiles import (ADOBE_RGB, ADOBE_RGB_GAMMA, BT2020, COLOUR_SPACE, DISPLAY_P3, EXIF_DIRECTORY, INDEX,
                      INTEROPERABILITY, SRGB, exif_bytes, icc_cmyk, icc_grey, icc_rgb, srgb_of, srgb_of_lab,
                      srgb_to_linear)
from tool import FAST, ToolTest, main

P3 = icc_rgb(DISPLAY_P3, name="Test P3")
ADOBE = icc_rgb(ADOBE_RGB, ADOBE_RGB_GAMMA, name="Test Adobe")
TIFF_ICC = 34675
WARNING = "warning: its colour profile is damaged or does not suit its pixels; it is taken as sRGB"
BLACK = 10  # lightness of black ink
INKS = [(100, 0, 0), (BLACK, 0, 0), (90, 0, 80), (BLACK, 0, 0), (50, 50, 0), (BLACK, 0, 0), (50, 60, 40), (BLACK, 0, 0),
        (60, -20, -30), (BLACK, 0, 0), (50, -60, 30), (BLACK, 0, 0), (30, 20, -40), (BLACK, 0, 0), (20, 0, 0),
        (BLACK, 0, 0)]


def converted(image, primaries, gamma=None):
    """The image in sRGB."""
    size, peak, samples = image.channels, image.peak, []
    for at in range(0, len(image.samples), size):
        pixel = image.samples[at:at + size]
        colours = pixel[:3] if size >= 3 else pixel[:1] * 3
        result = [round(peak * v) for v in srgb_of([v / peak for v in colours], primaries, gamma)]
        samples += result[:3 if size >= 3 else 1] + (pixel[-1:] if image.has_alpha else [])
    return Image(image.width, image.height, size, image.depth, samples)


def chromaticities(primaries):
    return b"cHRM", struct.pack(">8I", *(round(100000 * value) for xy in primaries for value in xy))


def gamma_chunk(exponent):
    return b"gAMA", struct.pack(">I", round(100000 / exponent))


def cicp(primaries, transfer, matrix=0, full_range=1):
    return b"cICP", bytes((primaries, transfer, matrix, full_range))


class ColourTest(ToolTest):
    def read(self, name, data, expected, message, tolerance=1.001):
        """Reads a file, whose pixels must be those of `expected`, and whose notes must be `message`, match it, or nothing."""
        self.write(name, data)
        self.write_png("expected.png", expected)
        done = self.start("compare", "expected.png", name, "--json")
        error = done.stderr.decode()
        self.assertEqual(done.returncode, 0, error)
        if isinstance(message, re.Pattern):
            self.assertRegex(error, message)
        else:
            self.assertEqual(error, f"{message}\n" if message else "")
        self.write("report.json", done.stdout)
        difference = float(done.stdout.split(b'"max_difference":')[1].split(b",")[0].strip(b" }\n"))
        self.assertLessEqual(difference, tolerance)

    def from_to_srgb(self, name, source):
        return f"{name}: colours converted from {source} to sRGB"

    def damaged(self, name, data, image):
        self.read(name, data, image, f"gscl: {name}: {WARNING}", 0)


class Profiles(ColourTest):
    def test_each_format(self):
        image = blocks(scene(40, 24))
        for profile, name, primaries, gamma in ((P3, "Test P3", DISPLAY_P3, None),
                                                (ADOBE, "Test Adobe", ADOBE_RGB, ADOBE_RGB_GAMMA)):
            expected = converted(image, primaries, gamma)
            self.assertNotEqual(expected.samples, image.samples)
            for file, data in (("in.png", png_bytes(image, [png_icc(profile)])),
                               ("in.jpg", jpeg_bytes(image, jpeg_icc(profile))),
                               ("in.tif", tiff_bytes(image, blocks=[(TIFF_ICC, profile)])),
                               ("in.webp", webp_bytes(image, [(b"ICCP", profile)]))):
                with self.subTest(file=file, name=name):
                    self.read(file, data, expected, self.from_to_srgb(file, name))

    def test_profile_in_parts(self):
        image = blocks(scene(24, 16))
        parts = jpeg_icc(P3, 100)
        self.assertGreater(len(parts), 3)
        expected = converted(image, DISPLAY_P3)
        self.read("in.jpg", jpeg_bytes(image, parts[::-1]), expected, self.from_to_srgb("in.jpg", "Test P3"))

    def test_precision_of_16_bits(self):
        image = scene(24, 16, 3, 16)
        for file, data in (("in.png", png_bytes(image, [png_icc(P3)])),
                           ("in.tif", tiff_bytes(image, blocks=[(TIFF_ICC, P3)]))):
            with self.subTest(file=file):
                expected = converted(image, DISPLAY_P3)
                self.read(file, data, expected, self.from_to_srgb(file, "Test P3"), 0.02)

    def test_grey(self):
        image = scene(24, 16, 1)
        ramp = converted(image, SRGB, 1.8)
        self.read("in.png", png_bytes(image, [png_icc(icc_grey(1.8))]), ramp, self.from_to_srgb("in.png", "Test Grey"))
        self.read("in.png", png_bytes(image, [png_icc(icc_rgb(DISPLAY_P3, 1.8))]), ramp,
                  self.from_to_srgb("in.png", "Test RGB"))

    def test_alpha_is_not_converted(self):
        image = scene(24, 16, 4)
        expected = converted(image, ADOBE_RGB, ADOBE_RGB_GAMMA)
        self.read("in.png", png_bytes(image, [png_icc(ADOBE)]), expected, self.from_to_srgb("in.png", "Test Adobe"))
        multiplied = Image(24, 16, 4, 8, [round(value) for value in image.normal()])
        multiplied.samples[3::4] = image.samples[3::4]
        self.read("in.tif", tiff_bytes(multiplied, extra_samples=(1,), blocks=[(TIFF_ICC, ADOBE)]), expected,
                  self.from_to_srgb("in.tif", "Test Adobe"), 4.0)

    def test_srgb_needs_no_conversion(self):
        image = scene(24, 16)
        self.read("in.png", png_bytes(image, [png_icc(icc_rgb(SRGB))]), image, "", 0)
        self.read("in.tif", tiff_bytes(scene(24, 16, 1), blocks=[(TIFF_ICC, icc_grey(None))]), scene(24, 16, 1), "", 0)

    def test_quiet(self):
        self.write("in.png", png_bytes(scene(24, 16), [png_icc(P3)]))
        self.write("bad.png", png_bytes(scene(24, 16), [png_icc(P3[:300])]))
        done = self.start("encode", "in.png", "bad.png", *FAST, "--quiet")
        self.assertEqual((done.returncode, done.stderr), (0, b""))

    def test_both_images_are_converted(self):
        """Encoding an image with a profile gives the same file as encoding it in sRGB."""
        image = scene(24, 16)
        self.assertEqual(self.encode(png_bytes(image, [png_icc(P3)])), self.encode(converted(image, DISPLAY_P3)))


class Chunks(ColourTest):
    """What PNG and OpenEXR say without a profile."""

    def png(self, chunks, expected, source, tolerance=1.0):
        message = self.from_to_srgb("in.png", source) if source else ""
        self.read("in.png", png_bytes(scene(24, 16), chunks), expected, message, tolerance)

    def test_code_points(self):
        image = scene(24, 16)
        self.png([cicp(12, 13)], converted(image, DISPLAY_P3), "Display P3")
        self.png([cicp(9, 14)], converted(image, BT2020), "BT.2020")
        self.png([cicp(1, 13)], image, "", 0)

    def test_gamma_and_primaries(self):
        image, source = scene(24, 16), "the primaries and the gamma of the file"
        self.png([gamma_chunk(1.8)], converted(image, SRGB, 1.8), source)
        self.png([gamma_chunk(1.8), chromaticities(BT2020)], converted(image, BT2020, 1.8), source)
        self.png([gamma_chunk(2.2), chromaticities(SRGB)], image, "", 0)

    def test_order_of_precedence(self):
        image = scene(24, 16)
        weakest = [gamma_chunk(1.0), chromaticities(BT2020)]
        self.png([(b"sRGB", b"\0"), *weakest], image, "", 0)
        self.png([png_icc(ADOBE), *weakest], converted(image, ADOBE_RGB, ADOBE_RGB_GAMMA), "Test Adobe")
        self.png([cicp(12, 13), png_icc(ADOBE), *weakest], converted(image, DISPLAY_P3), "Display P3")

    def test_linear_light_of_16_bits(self):
        image = scene(24, 16, 3, 16)
        self.read("in.png", png_bytes(image, [gamma_chunk(1.0)]), converted(image, SRGB, 1.0),
                  self.from_to_srgb("in.png", "the primaries and the gamma of the file"), 0.05)

    def test_hdr_is_refused(self):
        for transfer, name in ((16, "PQ"), (18, "HLG")):
            self.write("in.png", png_bytes(scene(24, 16), [cicp(9, transfer)]))
            self.refused("in.png", f"HDR.*BT.2020 {name}.*--keep-profile", "encode", "in.png", "-o", "out.gscl", *FAST)

    def test_primaries_of_exr(self):
        image = scene(20, 15, 3)
        linear = [srgb_to_linear(sample / 255) for sample in image.samples]
        data = exr_bytes(20, 15, {"R": linear[0::3], "G": linear[1::3], "B": linear[2::3]}, primaries=BT2020)
        self.read("in.exr", data, converted(image, BT2020),
                  self.from_to_srgb("in.exr", "the primaries and the gamma of the file"))

    def test_adobe_rgb_by_exif(self):
        """Cameras that are set to Adobe RGB say so in EXIF and may store no profile."""
        image = blocks(scene(24, 16))
        expected = converted(image, ADOBE_RGB, ADOBE_RGB_GAMMA)
        for order in "<>":
            exif = exif_bytes([(EXIF_DIRECTORY, [(COLOUR_SPACE, 65535), (INTEROPERABILITY, [(INDEX, "R03")])])], order)
            self.read("in.jpg", jpeg_bytes(image, [jpeg_exif(exif)]), expected,
                      self.from_to_srgb("in.jpg", "Adobe RGB, as its EXIF says,"))
            self.read("in.jpg", jpeg_bytes(image, [jpeg_exif(exif), *jpeg_icc(P3)]), converted(image, DISPLAY_P3),
                      self.from_to_srgb("in.jpg", "Test P3"))


class Inks(ColourTest):
    # No ink, all inks, and the single inks but black: entries of INKS, in which the last ink changes fastest.
    CORNERS = [((0, 0, 0, 0), 0), ((255, 255, 255, 255), 15), ((0, 255, 0, 0), 4), ((255, 0, 0, 0), 8)]

    def test_profile_of_inks(self):
        profile = icc_cmyk(INKS)
        for inks, corner in self.CORNERS:
            expected = flat(16, 8, tuple(round(255 * value) for value in srgb_of_lab(INKS[corner], BLACK)))
            inverted = flat(16, 8, tuple(255 - ink for ink in inks))
            adobe = (0xEE, b"Adobe\0\x64\0\0\0\0\0")
            for file, data in (("in.tif", tiff_bytes(flat(16, 8, inks), photometric=5, blocks=[(TIFF_ICC, profile)])),
                               ("in.jpg", jpeg_bytes(flat(16, 8, inks), jpeg_icc(profile))),
                               ("in.jpg", jpeg_bytes(inverted, [adobe, *jpeg_icc(profile)]))):
                with self.subTest(file=file, inks=inks):
                    self.read(file, data, expected, self.from_to_srgb(file, "Test CMYK"), 3.0)

    def test_inks_without_profile(self):
        inks = flat(16, 8, (0, 255, 0, 0))
        for file, data in (("in.tif", tiff_bytes(inks, photometric=5)), ("in.jpg", jpeg_bytes(inks))):
            self.write(file, data)
            self.refused(file, "holds CMYK colours without a colour profile; convert it to RGB first", "encode", file)

    def test_profile_of_other_colours(self):
        inks = flat(16, 8, (0, 255, 0, 0))
        self.write("in.jpg", jpeg_bytes(inks, jpeg_icc(P3)))
        self.refused("in.jpg", "holds CMYK.*a colour profile that is damaged or not for CMYK", "encode", "in.jpg")
        image = blocks(scene(24, 16))
        self.damaged("in.jpg", jpeg_bytes(image, jpeg_icc(icc_cmyk(INKS))), image)
        self.damaged("in.jpg", jpeg_bytes(image, jpeg_icc(icc_grey(1.8))), image)


class Damaged(ColourTest):
    """Profiles of any content: the image is read, and a warning says that its profile is not used."""

    def test_truncated_profile(self):
        image = blocks(scene(24, 16))
        for size in (1, 127, 128, 131, 132, 200, 300, len(P3) - 200):
            with self.subTest(size=size):
                self.damaged("in.png", png_bytes(image, [png_icc(P3[:size])]), image)
                self.damaged("in.jpg", jpeg_bytes(image, jpeg_icc(P3[:size])), image)
                self.damaged("in.tif", tiff_bytes(image, blocks=[(TIFF_ICC, P3[:size])]), image)
                self.damaged("in.webp", webp_bytes(image, [(b"ICCP", P3[:size])]), image)

    def test_damaged_chunks(self):
        image = scene(24, 16)
        good = png_bytes(image, [png_icc(P3)])
        for at in (good.index(b"iCCP") + 4, good.index(b"iCCP") + 60):  # a byte of the name, and of the profile
            self.damaged("in.png", good[:at] + bytes([good[at] ^ 1]) + good[at + 1:], image)
        for content in (b"", b"name", b"name\0", b"name\0\1" + bytes(20), b"name\0\0", b"name\0\0" + bytes(50)):
            with self.subTest(content=content):
                self.damaged("in.png", png_bytes(image, [(b"iCCP", content)]), image)
        for content in (b"", b"\1", bytes((12, 13, 1, 1)), bytes((12, 13, 0, 0)), bytes((3, 13, 0, 1)),
                        bytes((12, 3, 0, 1)), bytes((12, 13, 0, 1, 0))):
            with self.subTest(content=content):
                self.damaged("in.png", png_bytes(image, [(b"cICP", content)]), image)

    def test_damaged_segments(self):
        image = blocks(scene(24, 16))
        parts = jpeg_icc(P3, 100)
        icc = b"ICC_PROFILE\0"
        for segments in (parts[1:], parts[:-1], parts + parts[:1], [(0xE2, icc)], [(0xE2, icc + b"\1")],
                         [(0xE2, icc + b"\1\1")], [(0xE2, icc + b"\0\1abc")], [(0xE2, icc + b"\2\1abc")]):
            with self.subTest(segments=segments[:1]):
                self.damaged("in.jpg", jpeg_bytes(image, segments), image)

    def test_forged_values(self):
        """Each 32-bit field of the header and of the table of tags is set to its largest value, and to 0."""
        image = blocks(scene(16, 8))
        for at in (*range(0, 44, 4), *range(64, 84, 4), *range(128, 132 + 12 * 9, 4)):
            for value in (b"\xff\xff\xff\xff", b"\0\0\0\0"):
                self.write("in.jpg", jpeg_bytes(image, jpeg_icc(P3[:at] + value + P3[at + 4:])))
                done = self.start("compare", "in.jpg", "in.jpg")
                self.assertEqual(done.returncode, 0, (at, done.stderr))

    def test_primaries_without_triangle(self):
        image = scene(24, 16)
        point = (0.3127, 0.3290)
        for primaries in ((point,) * 4, (point, (0.6, 0.3), (0.6, 0.3), (0.1, 0.1)), ((0.9, 0.0), *SRGB[1:]),
                          ((9.0, 9.0), *DISPLAY_P3[1:])):
            self.damaged("in.png", png_bytes(image, [chromaticities(primaries)]), image)


class Avif(ColourTest):
    """OpenImageIO reads the pixels of HEIF files only."""

    def test_code_points_and_profile(self):
        width, height, colour = AVIF_IMAGE
        image = flat(width, height, colour)
        self.read("in.avif", avif_bytes(), image, "")
        self.read("in.avif", avif_bytes((1, 13)), image, "")
        self.read("in.avif", avif_bytes((12, 13)), converted(image, DISPLAY_P3),
                  self.from_to_srgb("in.avif", "Display P3"))
        self.read("in.avif", avif_bytes((12, 13), ADOBE), converted(image, ADOBE_RGB, ADOBE_RGB_GAMMA),
                  self.from_to_srgb("in.avif", "Test Adobe"))

    def test_standard_input(self):
        width, height, colour = AVIF_IMAGE
        self.write_png("in.png", converted(flat(width, height, colour), DISPLAY_P3))
        done = self.start("compare", "in.png", "-", input=avif_bytes((12, 13)))
        self.assertEqual(done.stderr.decode(), "standard input: colours converted from Display P3 to sRGB\n")
        self.assertRegex(done.stdout.decode(), "max difference        [01]\\.")

    def test_damaged_profile(self):
        width, height, colour = AVIF_IMAGE
        for profile in (b"", ADOBE[:200]):
            self.damaged("in.avif", avif_bytes(profile=profile), flat(width, height, colour))

    def test_hdr(self):
        self.write("in.avif", avif_bytes((9, 16)))
        self.refused("in.avif", "HDR.*BT.2020 PQ", "encode", "in.avif", "-o", "out.gscl")


class Kept(ColourTest):
    """gscl encode --keep-profile, and what decode makes of it."""

    def keep(self, data, *arguments):
        return self.encode(data, "--keep-profile", *arguments)

    def decode_to(self, suffix):
        """Decodes in.gscl.  Returns the bytes of the output and the notes."""
        done = self.start("decode", "in.gscl", "-o", f"out.{suffix}")
        self.assertEqual(done.returncode, 0, done.stderr)
        return self.path(f"out.{suffix}").read_bytes(), done.stderr.decode()

    def test_profile_is_stored_and_written(self):
        image = scene(24, 16)
        plain = self.encode(image)
        expected = self.decode()
        kept = self.keep(png_bytes(image, [png_icc(ADOBE)]))
        self.assertEqual(contained(plain[5:-2], before=block(ICC, ADOBE)), kept)  # the target does not count the block
        for suffix in ("png", "jpg", "tif"):
            data, notes = self.decode_to(suffix)
            self.assertEqual((metadata_of(data), notes), ((ADOBE, None, None), ""))
        self.assertEqual(self.decode(), expected)
        self.gscl("compare", "out.png", "out.tif")

    def test_grey_and_16_bits(self):
        profile = icc_grey(1.8)
        for channels, depth in ((1, 8), (2, 8), (1, 16)):
            image = scene(24, 16, channels, depth)
            self.encode(image)
            expected = self.decode()
            self.keep(png_bytes(image, [png_icc(profile)]))
            self.assertEqual(self.decode(), expected)
            data, notes = self.decode_to("tif")
            self.assertEqual((metadata_of(data)[0], notes), (profile, ""))

    def test_code_points_replace_profiles(self):
        image = scene(24, 16)
        plain = self.encode(image)[5:-2]
        for chunks, code, name in (([png_icc(P3)], bytes((12, 13)), "Display P3"),
                                   ([cicp(12, 13), png_icc(ADOBE)], bytes((12, 13)), "Display P3"),
                                   ([png_icc(icc_rgb(BT2020, 2.2))], bytes((9, 4)), "BT.2020"),
                                   ([cicp(9, 14)], bytes((9, 14)), "BT.2020")):
            with self.subTest(code=code):
                self.assertEqual(self.keep(png_bytes(image, chunks)),
                                 contained(plain, before=block(COLOUR_BLOCK, code)))
                png, notes = self.decode_to("png")
                self.assertEqual((png_parts(png)[b"cICP"], notes), (code + b"\0\1", ""))
                # Beside the code points, there is a profile of the same colours for readers that do not know them.
                profile = metadata_of(png)[0]
                self.assertEqual(metadata_of(self.decode_to("jpg")[0])[0], profile)
                decoded = read_png(png)
                self.read("profile.png", png_bytes(decoded, [png_icc(profile)]),
                          converted(decoded, DISPLAY_P3 if code[0] == 12 else BT2020, 2.2 if code[1] == 4 else None),
                          self.from_to_srgb("profile.png", name))

    def test_nothing_is_stored_for_srgb(self):
        image = scene(24, 16)
        self.assertEqual(self.keep(png_bytes(image, [png_icc(icc_rgb(SRGB))])), self.encode(image))
        self.assertEqual(self.keep(png_bytes(image, [cicp(1, 13)])), self.encode(image))
        self.assertEqual(set(png_parts(self.decode_to("png")[0])), {b"IHDR", b"IDAT", b"IEND"})

    def test_gamma_and_primaries_become_a_profile(self):
        image = scene(24, 16)
        self.keep(png_bytes(image, [gamma_chunk(1.8), chromaticities(DISPLAY_P3)]))
        data, notes = self.decode_to("png")
        self.assertEqual(notes, "")
        decoded = read_png(data)
        self.read("out.png", data, converted(decoded, DISPLAY_P3, 1.8),
                  self.from_to_srgb("out.png", "as the encoded image"))
        kept = self.path("in.gscl").read_bytes()
        time.sleep(1.1)  # the profile has no date of its own
        self.assertEqual(self.keep(self.path("in.image").read_bytes()), kept)

    def test_hdr(self):
        for transfer, name in ((16, "PQ"), (18, "HLG")):
            image = scene(24, 16)
            plain = self.encode(image)[5:-2]
            kept = self.keep(png_bytes(image, [cicp(9, transfer)]))
            self.assertEqual(kept, contained(plain, before=block(COLOUR_BLOCK, bytes((9, transfer)))))
            png, notes = self.decode_to("png")
            self.assertEqual((png_parts(png)[b"cICP"], metadata_of(png)[0], notes),
                             (bytes((9, transfer, 0, 1)), None, ""))
            for suffix in ("jpg", "tif", "ppm"):
                self.refused(f"x.{suffix}", f"HDR.*BT.2020 {name}.*choose .png", "decode", "in.gscl", "-o", f"x.{suffix}")

    def test_formats_without_profile(self):
        self.keep(png_bytes(scene(24, 16), [png_icc(ADOBE)]))
        for suffix, depth, tolerance in (("ppm", 8, 1.0), ("bmp", 8, 1.0), ("tga", 8, 1.0), ("exr", 16, 0.5)):
            with self.subTest(suffix=suffix):
                expected = converted(self.decode("--depth", depth), ADOBE_RGB, ADOBE_RGB_GAMMA)
                data, notes = self.decode_to(suffix)
                self.assertEqual(notes, self.from_to_srgb(f"out.{suffix}", "Test Adobe") +
                                 f", because .{suffix} holds no colour profile\n")
                # OpenEXR also holds the colours that sRGB does not have.
                outside = re.compile(r"\Agscl: out.exr: warning: \d+ samples lie outside 0..1 and are clamped; .*\n\Z")
                self.read(f"out.{suffix}", data, expected, outside if suffix == "exr" else "", tolerance)

    def test_colours_that_cannot_be_kept(self):
        self.write("in.jpg", jpeg_bytes(flat(16, 8, (0, 255, 0, 0)), jpeg_icc(icc_cmyk(INKS))))
        self.write("in.png", png_bytes(scene(16, 8, 1), [png_icc(icc_rgb(ADOBE_RGB, 1.8))]))
        for name, source in (("in.jpg", "Test CMYK"), ("in.png", "Test RGB")):
            done = self.start("encode", name, "-o", "out.gscl", "--keep-profile", *FAST)
            self.assertIn(self.from_to_srgb(name, source), done.stderr.decode())
            self.assertEqual(self.gscl_json("info", "out.gscl")["blocks"], [])

    def test_verbose(self):
        self.write("in.png", png_bytes(scene(16, 8), [png_icc(P3)]))
        self.write("b.png", png_bytes(scene(16, 8), [png_icc(ADOBE)]))
        notes = self.start("encode", "in.png", "b.png", "--keep-profile", "-v", *FAST).stderr.decode()
        self.assertIn("in.png: colours of Test P3 kept as code points 12, 13\n", notes)
        self.assertIn(f"b.png: colours of Test Adobe kept, with a profile of {len(ADOBE)} bytes\n", notes)
        self.assertIn(f"out.png: colour profile of {len(ADOBE)} bytes written\n",
                      self.start("decode", "b.gscl", "-o", "out.png", "-v").stderr.decode())

    def test_reference_of_info(self):
        """The image that was encoded is compared in its own colours."""
        self.keep(png_bytes(scene(24, 16), [png_icc(ADOBE)]))
        done = self.start("info", "in.gscl", "--reference", "in.image", "--json")
        self.assertEqual((done.returncode, done.stderr), (0, b""))

    def test_forged_blocks(self):
        """Profiles of any content in a gscl file: a warning, and the colours are taken as sRGB."""
        for channels, profiles in ((3, (b"x", ADOBE[:200], icc_grey(1.8), icc_cmyk(INKS))), (1, (ADOBE,))):
            self.forged_profiles(scene(16, 8, channels), profiles)
        picture = self.encode(scene(16, 8))[5:-2]
        self.write("in.gscl", contained(picture, before=block(COLOUR_BLOCK, bytes((200, 99)))))
        self.assertEqual(png_parts(self.decode_to("png")[0])[b"cICP"], bytes((200, 99, 0, 1)))
        self.assertIn("unknown kind", self.decode_to("jpg")[1])

    def forged_profiles(self, image, profiles):
        picture = self.encode(image)[5:-2]
        expected = self.decode()
        for profile in profiles:
            self.write("in.gscl", contained(picture, before=block(ICC, profile)))
            for suffix in ("png", "jpg", "pnm"):
                data, notes = self.decode_to(suffix)
                self.assertRegex(notes, r"\Agscl: out.\w+: warning: the colours of the file are of an unknown kind;"
                                        r"[^\n]*\n\Z")
            self.assertEqual(self.decode(), expected)

    def test_profile_precedes_code_points(self):
        picture = self.encode(scene(16, 8))[5:-2]
        both = block(COLOUR_BLOCK, bytes((12, 13)), last=False) + block(ICC, ADOBE)
        self.write("in.gscl", contained(picture, before=both))
        parts = png_parts(self.decode_to("png")[0])
        self.assertNotIn(b"cICP", parts)
        self.assertEqual(metadata_of(self.path("out.png").read_bytes())[0], ADOBE)


if __name__ == "__main__":
    main()
