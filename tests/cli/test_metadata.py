"""Orientation, EXIF and XMP of images."""
import struct
import unittest

from images import (Image, blocks, jpeg_bytes, jpeg_exif, jpeg_xmp, png_bytes, png_xmp, scene, tiff_bytes, webp_bytes)
from profiles import EXIF_DIRECTORY, INTEROPERABILITY, ORIENTATION, exif_bytes
from tool import FAST, ToolTest, main

MAKE, COPYRIGHT = 0x010F, 0x8298
WARNING = "warning: its EXIF is damaged; it is taken as upright"
XMP = b"<x:xmpmeta xmlns:x='adobe:ns:meta/'>text</x:xmpmeta>"

# The pixel of the upright image that is stored at column x, row y of an image that is w wide and h high upright.
STORED = {1: lambda x, y, w, h: (x, y), 2: lambda x, y, w, h: (w - 1 - x, y), 3: lambda x, y, w, h: (w - 1 - x, h - 1 - y),
          4: lambda x, y, w, h: (x, h - 1 - y), 5: lambda x, y, w, h: (y, x), 6: lambda x, y, w, h: (w - 1 - y, x),
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
            for order in "<>":
                files = files_with_exif(turned, exif_bytes([(MAKE, "gscl"), (ORIENTATION, orientation)], order))
                files["in.tif"] = tiff_bytes(turned, orientation=orientation)
                for name, data in files.items():
                    with self.subTest(name=name, orientation=orientation, order=order):
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
        self.write("in.jpg", jpeg_bytes(blocks(scene(24, 16)), [jpeg_exif(exif_bytes([(MAKE, "gscl")])), jpeg_xmp(XMP)]))
        done = self.start("encode", "in.jpg", "-o", "out.gscl", *FAST)
        self.assertRegex(done.stderr.decode(), r"\Aout.gscl: [^\n]*\n\Z")


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

    def test_forged_tiff(self):
        """The same for the types, counts and values of a directory of a TIFF file: it is read or refused."""
        exif = (EXIF_DIRECTORY, b"\0\1\0\1\0\3\0\0\0\1\0\1\0\0")
        good = tiff_bytes(scene(4, 4), blocks=[(700, XMP), (33723, b"iptc"), exif, (34675, bytes(40)), (34853, bytes(9))])
        start = struct.unpack_from(">I", good, 4)[0]
        for at in range(start + 12 * 10, len(good) - 4, 2):
            self.write("in.tif", good[:at] + b"\xff\xff" + good[at + 2:])
            self.assertIn(self.start("compare", "in.tif", "in.tif").returncode, (0, 1), at)


if __name__ == "__main__":
    main()
