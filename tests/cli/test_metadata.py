"""Orientation, EXIF and XMP of images."""
import struct
import unittest

from gscl_file import EXIF, block, contained
from gscl_file import XMP as XMP_BLOCK
from images import (AVIF_IMAGE, Image, avif_bytes, avif_exif, avif_xmp, blocks, jpeg_bytes, jpeg_exif, jpeg_xmp,
                    metadata_of, png_bytes, png_xmp, read_png, scene, tiff_bytes, webp_bytes)
from profiles import (COLOUR_SPACE, EXIF_DIRECTORY, INDEX, INTEROPERABILITY, ORIENTATION, exif_bytes, exif_directory,
                      exif_values)
from tool import FAST, ToolTest, main

MAKE, COPYRIGHT = 0x010F, 0x8298
WARNING = "warning: its EXIF is damaged; it is taken as upright"
XMP = b"<x:xmpmeta xmlns:x='adobe:ns:meta/'>text</x:xmpmeta>"

# The pixel of the upright image that is stored at column x, row y of an image that is w wide and h high upright.
STORED = {1: lambda x, y, w, h: (x, y), 2: lambda x, y, w, h: (w - 1 - x, y),
          3: lambda x, y, w, h: (w - 1 - x, h - 1 - y), 4: lambda x, y, w, h: (x, h - 1 - y),
          5: lambda x, y, w, h: (y, x), 6: lambda x, y, w, h: (w - 1 - y, x),
          7: lambda x, y, w, h: (w - 1 - y, h - 1 - x), 8: lambda x, y, w, h: (y, h - 1 - x)}


def stored(image, orientation):
    """The image as a file with this orientation stores it."""
    w, h, size = image.width, image.height, image.channels
    width, height = (w, h) if orientation < 5 else (h, w)
    samples = []
    for y in range(height):
        for x in range(width):
            column, row = STORED[orientation](x, y, w, h)
            samples += image.row(row)[column * size:(column + 1) * size]
    return Image(width, height, size, image.depth, samples)


def files_with_exif(image, exif):
    return {"in.png": png_bytes(image, [(b"eXIf", exif)]), "in.jpg": jpeg_bytes(image, [jpeg_exif(exif)]),
            "in.webp": webp_bytes(image, [(b"EXIF", exif)])}


class MetadataTest(ToolTest):
    def same(self, name, data, expected, message=""):
        self.write(name, data)
        self.write_png("expected.png", expected)
        done = self.start("compare", "expected.png", name)
        self.assertEqual((done.returncode, done.stderr.decode()), (0, f"{message}\n" if message else ""))
        self.assertIn(b"max difference        0.00", done.stdout)

    def notes(self, name, data, *arguments):
        """Encodes a file with -v and returns the lines about its reading."""
        self.write(name, data)
        done = self.start("encode", name, "-o", "out.gscl", "-v", *FAST, *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return [line for line in done.stderr.decode().splitlines() if line.startswith(f"{name}: ")]


class Orientation(MetadataTest):
    def test_each_orientation_and_format(self):
        image = blocks(scene(40, 24))
        for orientation in range(1, 9):
            turned = stored(image, orientation)
            order = "<>"[orientation % 2]
            files = files_with_exif(turned, exif_bytes([(MAKE, "gscl"), (ORIENTATION, orientation)], order))
            files["in.tif"] = tiff_bytes(turned, orientation=orientation)
            for name, data in files.items():
                with self.subTest(name=name, orientation=orientation):
                    self.same(name, data, image)

    def test_each_kind_of_pixel(self):
        for channels in (1, 2, 3, 4):
            for depth in (8, 16):
                with self.subTest(channels=channels, depth=depth):
                    image = scene(13, 7, channels, depth)
                    exif = exif_bytes([(ORIENTATION, 6)])
                    self.same("in.png", png_bytes(stored(image, 6), [(b"eXIf", exif)]), image)

    def test_prefix_of_exif(self):
        """Some programs store the prefix that belongs to JPEG in other formats too."""
        image = scene(13, 7)
        exif = b"Exif\0\0" + exif_bytes([(ORIENTATION, 3)])
        self.same("in.png", png_bytes(stored(image, 3), [(b"eXIf", exif)]), image)
        self.same("in.webp", webp_bytes(stored(image, 3), [(b"EXIF", exif)]), image)

    def test_orientations_that_do_not_exist(self):
        image = blocks(scene(24, 16))
        for orientation in (0, 9, 65535):
            for name, data in files_with_exif(image, exif_bytes([(ORIENTATION, orientation)])).items():
                with self.subTest(name=name, orientation=orientation):
                    self.same(name, data, image)

    def test_verbose(self):
        image = blocks(scene(24, 16))
        data = jpeg_bytes(stored(image, 8), [jpeg_exif(exif_bytes([(ORIENTATION, 8)]))])
        self.assertIn("in.jpg: turned upright (orientation 8)", self.notes("in.jpg", data))


class Dropped(MetadataTest):
    def test_verbose_says_what_is_dropped(self):
        image = blocks(scene(24, 16))
        exif = exif_bytes([(MAKE, "gscl")])
        expected = [f"EXIF of {len(exif)} bytes dropped", f"XMP of {len(XMP)} bytes dropped"]
        files = {"in.png": png_bytes(image, [(b"eXIf", exif), png_xmp(XMP)]),
                 "in.jpg": jpeg_bytes(image, [jpeg_exif(exif), jpeg_xmp(XMP)]),
                 "in.webp": webp_bytes(image, [(b"EXIF", exif), (b"XMP ", XMP)]),
                 "in.tif": tiff_bytes(image, blocks=[(700, XMP), (COPYRIGHT, b"nobody\0")])}
        for name, data in files.items():
            with self.subTest(name=name):
                notes = self.notes(name, data)
                if name == "in.tif":
                    self.assertRegex(notes[0], r"in.tif: EXIF of \d+ bytes dropped")
                    notes, expected = notes[1:], expected[1:]
                self.assertEqual(notes, [f"{name}: {text}" for text in expected])

    def test_packed_xmp(self):
        self.assertIn(f"in.png: XMP of {len(XMP)} bytes dropped",
                      self.notes("in.png", png_bytes(scene(24, 16), [png_xmp(XMP, packed=True)])))

    def test_other_metadata(self):
        image = blocks(scene(24, 16))
        self.assertEqual(self.notes("in.jpg", jpeg_bytes(image, [(0xFE, b"a comment"), (0xED, b"Photoshop 3.0\0")])),
                         ["in.jpg: other metadata of 23 bytes dropped"])
        self.assertEqual(self.notes("in.png", png_bytes(image, [(b"tEXt", b"Title\0none")])),
                         ["in.png: other metadata of 10 bytes dropped"])

    def test_nothing_is_said_by_default(self):
        segments = [jpeg_exif(exif_bytes([(MAKE, "gscl")])), jpeg_xmp(XMP)]
        self.write("in.jpg", jpeg_bytes(blocks(scene(24, 16)), segments))
        done = self.start("encode", "in.jpg", "-o", "out.gscl", *FAST)
        self.assertRegex(done.stderr.decode(), r"\Aout.gscl: [^\n]*\n\Z")


class Kept(MetadataTest):
    """gscl encode --metadata, and what decode makes of it."""

    VALUES = [(MAKE, "gscl"), (0x0110, "a model"), (COPYRIGHT, "no rights reserved"),
              (EXIF_DIRECTORY, [(0x9286, "a comment of many words"), (COLOUR_SPACE, 1),
                                (INTEROPERABILITY, [(INDEX, "R98")])])]

    def exif(self, orientation, order=">"):
        """In a real file the entries are sorted by tag."""
        return exif_bytes(self.VALUES[:2] + [(ORIENTATION, orientation)] + self.VALUES[2:], order)

    def keep(self, data, metadata="all", *arguments):
        return self.encode(data, "--metadata", metadata, *arguments)

    def decode_to(self, suffix):
        """Decodes in.gscl.  Returns the bytes of the output and the notes."""
        done = self.start("decode", "in.gscl", "-o", f"out.{suffix}")
        self.assertEqual(done.returncode, 0, done.stderr)
        return self.path(f"out.{suffix}").read_bytes(), done.stderr.decode()

    def test_round_trip(self):
        image = blocks(scene(24, 16))
        plain = self.encode(image)[5:-2]
        expected = self.decode()
        for order in "<>":
            exif = self.exif(1, order)
            both = contained(plain, after=block(EXIF, exif, last=False) + block(XMP_BLOCK, XMP))
            for data in (png_bytes(image, [(b"eXIf", exif), png_xmp(XMP)]),
                         jpeg_bytes(image, [jpeg_exif(exif), jpeg_xmp(XMP)]),
                         webp_bytes(image, [(b"EXIF", exif), (b"XMP ", XMP)])):
                with self.subTest(start=data[:4], order=order):
                    self.assertEqual(self.keep(data), both)
                    self.assertEqual(self.decode(), expected)
                    self.assertEqual(metadata_of(self.decode_to("png")[0]), (None, exif, XMP))
                    self.assertEqual(metadata_of(self.decode_to("jpg")[0]), (None, exif, XMP))
                    self.assertEqual(self.keep(data, "exif"), contained(plain, after=block(EXIF, exif)))
                    self.assertEqual(self.keep(data, "none"), contained(plain))
                    self.assertEqual(self.encode(data), contained(plain))

    def test_avif(self):
        exif, items = self.exif(1), [avif_exif(self.exif(6)), avif_xmp(XMP)]
        for items, expected in ((items, (None, exif, XMP)), (items[:1], (None, exif, None)),
                                (items[1:], (None, None, XMP)), (items[::-1], (None, exif, XMP)),
                                ([], (None, None, None))):
            self.keep(avif_bytes(items=items))
            self.assertEqual(metadata_of(self.decode_to("png")[0]), expected)
        self.assertEqual(read_png(self.path("out.png").read_bytes()).width, AVIF_IMAGE[0])
        # Orientation is a property of the image, and the reader of the pixels applies it; EXIF repeats it.
        self.assertEqual(self.notes("in.avif", avif_bytes(items=[avif_exif(self.exif(6))])),
                         [f"in.avif: EXIF of {len(exif)} bytes dropped"])

    def test_tiff(self):
        """A TIFF file holds EXIF in its own directories, which are rewritten as a block, and back."""
        for channels, depth in ((3, 8), (4, 16)):
            image = scene(24, 16, channels, depth)
            for order in "<>":
                exif = self.exif(1, order)
                self.keep(png_bytes(image, [(b"eXIf", exif), png_xmp(XMP)]))
                expected = self.decode()
                tiff, notes = self.decode_to("tif")
                self.assertEqual((tiff[:2], notes), (exif[:2], ""))
                tags = [tag for tag, _ in exif_values(tiff)]
                self.assertEqual(tags, sorted(tags))
                for value in exif_values(exif):
                    self.assertIn(value, exif_values(tiff))
                self.assertEqual(metadata_of(tiff)[2], XMP)
                self.same("out.tif", tiff, expected)
                self.keep(tiff, "all")
                again = metadata_of(self.decode_to("png")[0])
                self.assertEqual(again[2], XMP)
                self.assertEqual(exif_values(again[1]), [v for v in exif_values(exif) if v[0] != ORIENTATION])

    def test_orientation_is_stored_as_upright(self):
        image = blocks(scene(24, 16))
        packet = b'<a tiff:Orientation="%d"/><tiff:Orientation>%d</tiff:Orientation><tiff:Orientation>x'
        for order in "<>":
            data = jpeg_bytes(stored(image, 6), [jpeg_exif(self.exif(6, order)), jpeg_xmp(packet % (6, 6))])
            self.keep(data)
            png = self.decode_to("png")[0]
            self.assertEqual(metadata_of(png)[1:], (self.exif(1, order), packet % (1, 1)))
            self.assertEqual((read_png(png).width, read_png(png).height), (24, 16))

    def test_converted_colours_are_stored_as_srgb(self):
        def exif(space, index):
            return exif_bytes([(EXIF_DIRECTORY, [(COLOUR_SPACE, space), (INTEROPERABILITY, [(INDEX, index)])])])
        data = jpeg_bytes(blocks(scene(24, 16)), [jpeg_exif(exif(65535, "R03"))])
        self.keep(data)
        self.assertEqual(metadata_of(self.decode_to("png")[0])[1], exif(1, "R98"))
        self.keep(data, "exif", "--keep-profile")
        self.assertEqual(metadata_of(self.decode_to("png")[0])[1], exif(65535, "R03"))
        self.assertEqual(self.decode_to("ppm")[1].count("sRGB"), 1)

    def test_thumbnail_is_dropped(self):
        thumbnail = b"\xff\xd8" + bytes(500) + b"\xff\xd9"
        size = len(exif_bytes([(MAKE, "gscl")]))
        first = exif_directory(">", 8, [(MAKE, "gscl")], following=size)
        second = struct.pack(">HHHIIHHIII", 2, 0x0201, 4, 1, size + 30, 0x0202, 4, 1, len(thumbnail), 0)
        self.keep(jpeg_bytes(blocks(scene(24, 16)), [jpeg_exif(b"MM\0*\0\0\0\x08" + first + second + thumbnail)]))
        exif = metadata_of(self.decode_to("png")[0])[1]
        self.assertEqual(exif[:size], exif_bytes([(MAKE, "gscl")]))
        self.assertNotIn(b"\xff\xd8", exif)

    def test_formats_without_metadata(self):
        exif = self.exif(1)
        self.keep(png_bytes(scene(24, 16), [(b"eXIf", exif), png_xmp(XMP)]))
        for suffix in ("ppm", "bmp", "tga", "exr"):
            self.assertEqual(self.decode_to(suffix)[1],
                             f"out.{suffix}: EXIF of {len(exif)} bytes left out, because .{suffix} holds none\n"
                             f"out.{suffix}: XMP of {len(XMP)} bytes left out, because .{suffix} holds none\n")

    def test_segments_of_jpeg_are_short(self):
        for size, fits in ((65527, True), (65528, False)):
            exif = self.exif(1).ljust(size, b"\0")
            self.keep(png_bytes(scene(24, 16), [(b"eXIf", exif)]))
            data, notes = self.decode_to("jpg")
            self.assertEqual(metadata_of(data)[1], exif if fits else None)
            self.assertEqual(notes, "" if fits else
                             "out.jpg: EXIF of 65528 bytes left out, because .jpg holds at most 65527\n")

    def test_block_that_is_too_long(self):
        exif = self.exif(1).ljust(2 ** 21, b"\0")
        self.write("in.png", png_bytes(scene(24, 16), [(b"eXIf", exif)]))
        done = self.start("encode", "in.png", "-o", "out.gscl", "--metadata", "all", *FAST)
        self.assertRegex(done.stderr.decode(),
                         r"\Agscl: in.png: warning: its EXIF of 2097152 bytes is dropped[^\n]*\nout.gscl: ")
        self.assertEqual(self.gscl_json("info", "out.gscl")["blocks"], [])

    def test_targets(self):
        """A target counts the blocks; the default one does not."""
        exif = self.exif(1).ljust(1000, b"\0")
        self.write("in.png", png_bytes(scene(24, 16), [(b"eXIf", exif)]))
        self.refused("in.png", "budget of 900 bytes is too small: blocks.*take 10\\d\\d bytes", "encode", "in.png", "-o",
                     "x.gscl", "--metadata", "exif", "--bytes", "900", *FAST)
        self.gscl("encode", "in.png", "-o", "out.gscl", "--metadata", "exif", "--bytes", "1200", "--quiet", *FAST)
        self.assertIn(self.path("out.gscl").stat().st_size, range(1150, 1201))

    def test_bare(self):
        self.write_png("in.png", scene(24, 16))
        for option in (("--keep-profile",), ("--metadata", "exif")):
            self.refused("encode", "bare file.*leave out --bare", "encode", "in.png", "-o", "out.gscl", "--bare", *option,
                         code=2)

    def test_verbose(self):
        exif = self.exif(1)
        data = png_bytes(scene(24, 16), [(b"eXIf", exif), png_xmp(XMP)])
        self.assertEqual(self.notes("in.png", data, "--metadata", "exif"),
                         [f"in.png: EXIF of {len(exif)} bytes kept", f"in.png: XMP of {len(XMP)} bytes dropped"])
        self.assertIn(f"out.png: EXIF of {len(exif)} bytes written\n",
                      self.start("decode", "out.gscl", "-o", "out.png", "-v").stderr.decode())

    def test_forged_blocks(self):
        """EXIF and XMP of any content in a gscl file."""
        picture = self.encode(scene(16, 8))[5:-2]
        good = self.exif(1)
        for exif in (b"x", good[:9], bytes(30), good[:8] + b"\xff\xff" + good[10:]):
            self.write("in.gscl", contained(picture, after=block(EXIF, exif)))
            for suffix in ("png", "jpg", "tif", "ppm"):
                data, notes = self.decode_to(suffix)
                self.assertEqual(notes, f"gscl: out.{suffix}: warning: the EXIF of the file is damaged; it is left out\n")
                self.assertIsNone(metadata_of(data)[1] if suffix != "ppm" else None)
        for at in range(2, len(good) - 1, 2):
            exif = good[:at] + b"\xff\xff" + good[at + 2:]
            after = block(EXIF, exif, last=False) + block(XMP_BLOCK, b"\0tiff:Orientation=")
            self.write("in.gscl", contained(picture, after=after))
            self.assertIn(self.start("decode", "in.gscl", "-o", "out.tif").returncode, (0,), at)
            self.same("out.tif", self.path("out.tif").read_bytes(), self.decode())


class Damaged(MetadataTest):
    """EXIF of any content: the image is read."""

    def test_no_directory(self):
        image = blocks(scene(24, 16))
        good = exif_bytes([(ORIENTATION, 6)])
        for exif in (b"", b"I", b"II*\0", good[:7], good[:8], good[:9], good[:-16], b"XX" + good[2:], bytes(40),
                     good[:4] + b"\0\0\0\2" + good[8:], good[:4] + b"\xff\xff\xff\xff" + good[8:]):
            for name, data in files_with_exif(image, exif).items():
                with self.subTest(name=name, exif=exif):
                    self.same(name, data, image, f"gscl: {name}: {WARNING}" if exif else "")

    def test_forged_values(self):
        """Each 16-bit field is set to its largest value, and to a small one.  Two files are read at a time."""
        image = blocks(scene(16, 8))
        good = exif_bytes([(MAKE, "some maker"), (ORIENTATION, 1), (EXIF_DIRECTORY, [(MAKE, "text of any kind"), (
            INTEROPERABILITY, [(1, "R03")])])], "<")
        for at in range(2, len(good) - 1, 2):
            for name, value in (("a.jpg", b"\xff\xff"), ("b.jpg", b"\1\0")):
                self.write(name, jpeg_bytes(image, [jpeg_exif(good[:at] + value + good[at + 2:])]))
            done = self.start("compare", "a.jpg", "b.jpg")
            self.assertEqual(done.returncode, 0, (at, done.stderr))

    def test_values_outside(self):
        """A value of 16 bytes that begins near the end of the block, at it, or far beyond it."""
        image = blocks(scene(16, 8))
        size = len(exif_bytes([(ORIENTATION, 1)]))
        for offset in (size - 15, size, size + 1, 2 ** 31, 2 ** 32 - 16, 2 ** 32 - 1):
            entry = struct.pack(">HHHII", 1, ORIENTATION, 3, 8, offset)
            exif = struct.pack(">2sHI", b"MM", 42, 8) + entry + bytes(4)
            self.assertEqual(len(exif), size)
            self.same("in.png", png_bytes(image, [(b"eXIf", exif)]), image)

    def test_forged_chunks_of_webp(self):
        """Sizes of chunks that end beyond the file: the image is read or refused."""
        image = scene(16, 8)
        good = webp_bytes(image, [(b"EXIF", exif_bytes([(ORIENTATION, 1)])), (b"XMP ", XMP)])
        for name in (b"VP8X", b"VP8L", b"EXIF", b"XMP "):
            at = good.index(name) + 4
            for size in (0, 1, 1000, 2 ** 31, 2 ** 32 - 1):
                self.write("in.webp", good[:at] + struct.pack("<I", size) + good[at + 4:])
                self.assertIn(self.start("compare", "in.webp", "in.webp").returncode, (0, 1), (name, size))

    def test_forged_avif(self):
        """Boxes of any size and content: the image is read or refused."""
        good = avif_bytes((12, 13), bytes(40), [avif_exif(exif_bytes([(ORIENTATION, 1)])), avif_xmp(XMP)])
        names = (b"meta", b"iprp", b"ipco", b"colr", b"iinf", b"infe", b"iloc")
        places = [good.index(name) - 4 for name in names] + [good.index(b"iloc") + 4 + at for at in range(0, 24, 2)]
        for at in places:
            for value in (7, 2 ** 32 - 1):
                self.write("in.avif", good[:at] + struct.pack(">I", value) + good[at + 4:])
                self.assertIn(self.start("compare", "in.avif", "in.avif").returncode, (0, 1), (at, value))

    def test_forged_tiff(self):
        """The same for the types, counts and values of a directory of a TIFF file: it is read or refused."""
        exif = (EXIF_DIRECTORY, b"\0\1\0\1\0\3\0\0\0\1\0\1\0\0")
        fields = [(700, XMP), (33723, b"iptc"), exif, (34675, bytes(40)), (34853, bytes(9))]
        good = tiff_bytes(scene(4, 4), blocks=fields)
        start = struct.unpack_from(">I", good, 4)[0]
        for at in range(start + 2 + 12 * 10, len(good) - 4, 4):
            self.write("in.tif", good[:at] + b"\xff\xff\xff\xff" + good[at + 4:])
            self.assertIn(self.start("compare", "in.tif", "in.tif").returncode, (0, 1), at)


if __name__ == "__main__":
    main()
