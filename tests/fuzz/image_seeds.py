"""Images from which the fuzz target `image` starts: one of each format, depth and kind of metadata that the tool reads."""
import struct

from images import (Image, avif_bytes, avif_exif, avif_xmp, flat, jpeg_bytes, jpeg_exif, jpeg_icc, jpeg_xmp, pnm_bytes, png_bytes,
                    png_icc, png_palette_bytes, png_xmp, scene, tiff_bytes, webp_bytes)
from profiles import EXIF_DIRECTORY, ORIENTATION, exif_bytes, icc_cmyk, icc_grey, icc_rgb

ADOBE_RGB = (0.3127, 0.3290), (0.64, 0.33), (0.21, 0.71), (0.15, 0.06)
EXIF = exif_bytes([(ORIENTATION, 6), (EXIF_DIRECTORY, [(0xA001, 2), (0xA005, [(0x0001, "R03")])])])
LITTLE_EXIF = exif_bytes([(0x010F, "camera"), (ORIENTATION, 3)], order="<")
XMP = b'<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:Description tiff:Orientation="6"/></x:xmpmeta>'
KEEP_ALL, WRITE = b"\x07", b"\x27"  # the last byte of an input: see fuzz_image.c


def seeds():
    """Pairs of a name and bytes."""
    small = scene(5, 4)
    rgb, grey = icc_rgb(ADOBE_RGB, 2.2), icc_grey(1.8)
    cmyk = icc_cmyk([(90 - 5 * i, i, -i) for i in range(16)])
    chromaticities = b"cHRM", struct.pack(">8I", *(round(100000 * value) for xy in ADOBE_RGB for value in xy))
    chunks = {"icc": [png_icc(rgb)], "exif": [(b"eXIf", EXIF)], "xmp": [png_xmp(XMP)], "packed_xmp": [png_xmp(XMP, True)],
              "cicp": [(b"cICP", bytes((12, 13, 0, 1)))], "gamma": [(b"gAMA", struct.pack(">I", 100000)), chromaticities],
              "srgb": [(b"sRGB", b"\0"), (b"tEXt", b"Comment\0none")], "frames": [(b"acTL", struct.pack(">II", 2, 0))]}
    for name, extra in chunks.items():
        yield f"png_{name}", png_bytes(small, extra) + WRITE
    for channels in (1, 2, 4):
        yield f"png_{channels}", png_bytes(scene(3, 3, channels, 16)) + WRITE
    yield "png_grey_icc", png_bytes(scene(3, 3, 1), [png_icc(grey)]) + KEEP_ALL
    yield "png_palette", png_palette_bytes(2, 2, [(1, 2, 3, 4), (5, 6, 7, 8)], [0, 1, 1, 0]) + WRITE
    for name, segments in {"plain": [], "icc": jpeg_icc(rgb, 200), "exif": [jpeg_exif(LITTLE_EXIF), jpeg_xmp(XMP)],
                           "comment": [(0xFE, b"text"), (0xED, b"Photoshop 3.0\0")]}.items():
        yield f"jpeg_{name}", jpeg_bytes(flat(9, 3, (1, 2, 3)), segments) + WRITE
    yield "jpeg_grey", jpeg_bytes(flat(9, 3, (7,)), jpeg_icc(grey)) + WRITE
    inks = Image(8, 8, 4, 8, [9, 99, 199, 0] * 64)
    yield "jpeg_inks", jpeg_bytes(inks, [*jpeg_icc(cmyk, 4000), (0xEE, b"Adobe\0d\0\0\0\0\0")]) + KEEP_ALL
    blocks = [(700, XMP), (34377, b"8BIM"), (34675, rgb)]
    yield "tiff", tiff_bytes(small, orientation=8, blocks=blocks) + WRITE
    yield "tiff_inks", tiff_bytes(inks, photometric=5) + KEEP_ALL
    yield "tiff_exif", LITTLE_EXIF + KEEP_ALL
    yield "tiff_directories", EXIF + WRITE
    yield "webp", webp_bytes(flat(2, 2, (1, 2, 3)), [(b"ICCP", rgb), (b"EXIF", EXIF), (b"XMP ", XMP)])[:2000] + KEEP_ALL
    items = [avif_exif(EXIF), avif_xmp(XMP)]
    yield "avif", avif_bytes((12, 13), items=items) + WRITE
    yield "avif_icc", avif_bytes(profile=rgb, items=items) + KEEP_ALL
    yield "pnm", pnm_bytes(small) + WRITE
    yield from headers()


def headers():
    """Formats of which the tool reads the header only, but for icons."""
    pixels = bytes(range(64))
    dib = struct.pack("<IiiHHIIiiII", 40, 4, 4, 1, 32, 3, 64, 0, 0, 0, 0)
    masks = struct.pack("<IIII", 0xFF0000, 0xFF00, 0xFF, 0xFF000000)
    yield "bmp", b"BM" + struct.pack("<IHHI", 134, 0, 0, 70) + dib + masks + pixels + KEEP_ALL
    profile = struct.pack("<II", 124, 8)
    embedded = struct.pack("<I", 124) + dib[4:] + masks + b"DEBM" + bytes(48) + profile + bytes(4) + b"profile "
    yield "bmp_profile", b"BM" + struct.pack("<IHHI", 134, 0, 0, 138) + embedded + pixels + KEEP_ALL
    icon = struct.pack("<IiiHHIIiiII", 40, 4, 8, 1, 32, 0, 0, 0, 0, 0, 0) + pixels + bytes(16)
    folder = struct.pack("<HHH", 0, 1, 2)
    for name, bits in (("ico", 32), ("ico_palette", 1)):
        bitmap = icon[:14] + struct.pack("<H", bits) + icon[16:]
        png = png_bytes(scene(3, 3))
        entries = struct.pack("<BBBBHHII", 4, 4, 0, 0, 1, bits, len(bitmap), 38)
        entries += struct.pack("<BBBBHHII", 3, 3, 0, 0, 1, 32, len(png), 38 + len(bitmap))
        yield name, folder + entries + bitmap + png + WRITE
    tga = struct.pack("<BBBHHBHHHHBB", 0, 0, 2, 0, 0, 0, 0, 0, 4, 4, 32, 8) + pixels
    yield "tga", tga + WRITE
    area = struct.pack("<H", 495) + bytes(492) + b"\3"
    yield "tga_2", tga + area + struct.pack("<II", len(tga), 0) + b"TRUEVISION-XFILE.\0"
    yield "psd", b"8BPS" + struct.pack(">H6xHIIHH", 1, 3, 4, 4, 8, 3) + bytes(12) + b"\0\0" + pixels + KEEP_ALL
    yield "sgi", struct.pack(">hBBHHHHii4x80sI", 474, 0, 1, 2, 4, 4, 1, 0, 255, b"", 0) + pixels + KEEP_ALL
    yield "dds", b"DDS " + struct.pack("<18I", 124, *bytes(17)) + struct.pack("<II4s", 32, 4, b"DXT5") + bytes(40) + KEEP_ALL
    primaries = b"PRIMARIES=.64 .33 .21 .71 .15 .06 .3127 .329\n"
    yield "hdr", b"#?RADIANCE\nGAMMA=1\n" + primaries + b"FORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 4\n" + pixels + KEEP_ALL
    yield "pfm", b"PF\n2 2\n-1.0\n" + pixels[:48] + KEEP_ALL
    yield "pbm", b"P1\n# text\n2 2\n1 0 0 1\n" + KEEP_ALL
    frame = b"ANMF" + struct.pack("<I", 24) + bytes(24)
    animation = b"WEBPVP8X" + struct.pack("<I", 10) + b"\2" + bytes(9) + frame
    yield "webp_frames", b"RIFF" + struct.pack("<I", len(animation)) + animation + KEEP_ALL
    big = struct.pack("<2sHHHQ", b"II", 43, 8, 0, 16) + struct.pack("<Q", 5)
    for tag, kind, value in ((258, 3, 8), (262, 3, 3), (274, 3, 6), (320, 3, 7), (34675, 7, 1)):
        big += struct.pack("<HHQQ", tag, kind, 1, value)
    yield "big_tiff", big + bytes(8) + KEEP_ALL
