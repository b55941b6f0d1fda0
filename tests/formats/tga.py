"""TGA: by hand in all its kinds of pixels, origins, attribute bits and types of alpha, and by libraries."""

import struct

import numpy

from picture import HEIGHT, WIDTH, Sample, indexed, picture, scaled

REFUSED = r", 16 bits, 1 of alpha|, 16 bits of grey and alpha|palette of .* from 16|palette .*of alpha"

NO_ALPHA, IGNORED, RETAINED, STRAIGHT, MULTIPLIED = 0, 1, 2, 3, 4  # types of alpha in the area of extensions
BOTTOM_LEFT, BOTTOM_RIGHT, TOP_LEFT, TOP_RIGHT = 0, 0x10, 0x20, 0x30


def stored(rows, origin):
    rows = rows if origin & 0x20 else rows[::-1]
    return rows[:, ::-1] if origin & 0x10 else rows


def rle(pixels):
    """Packets of pixels, which are byte strings of one size, that stay within their row; runs and raw packets alternate."""
    out = b""
    for row in pixels:
        at = 0
        while at < len(row):
            run = 1
            while at + run < len(row) and run < 128 and row[at + run] == row[at]:
                run += 1
            if run > 1:
                out += bytes((127 + run,)) + row[at]
            else:
                run = min(5, len(row) - at)
                out += bytes((run - 1,)) + b"".join(row[at : at + run])
            at += run
    return out


def tga(
    kind,
    bits,
    pixels,
    origin=BOTTOM_LEFT,
    attribute_bits=0,
    palette=(),
    palette_bits=0,
    first=0,
    alpha_type=None,
    name=b"",
):
    """`pixels` are rows of byte strings, from the top left.  `alpha_type` writes the footer of version 2."""
    head = struct.pack(
        "<BBBHHBHHHHBB",
        len(name),
        bool(palette_bits),
        kind,
        first,
        len(palette),
        palette_bits,
        0,
        0,
        WIDTH,
        HEIGHT,
        bits,
        origin | attribute_bits,
    )
    table = numpy.empty((HEIGHT, WIDTH), object)
    for y, row in enumerate(pixels):
        for x, value in enumerate(row):
            table[y, x] = value
    table = stored(table, origin)
    body = rle(table.tolist()) if kind >= 9 else b"".join(b"".join(row) for row in table.tolist())
    data = head + name + b"".join(palette) + body
    if alpha_type is not None:
        extension = struct.pack("<H", 495).ljust(494, b"\0") + bytes((alpha_type,))
        data += extension + struct.pack("<II", len(data), 0) + b"TRUEVISION-XFILE.\0"
    return data


def bgr(samples):
    """8-bit RGB or RGBA as rows of byte strings."""
    order = [2, 1, 0, 3][: samples.shape[2]]
    return [[bytes(int(v) for v in pixel[order]) for pixel in row] for row in samples]


def words(samples, top_bit):
    """Samples of 0..1 in 5 bits each."""
    five = numpy.rint(samples[..., :3] * 31).astype(int)
    values = five[..., 0] << 10 | five[..., 1] << 5 | five[..., 2] | numpy.asarray(top_bit, int) << 15
    return [[struct.pack("<H", v) for v in row] for row in values], five / 31


def by_hand():
    rgb, rgba, grey = picture(3), picture(4), picture(1)
    for label, origin in {
        "": BOTTOM_LEFT,
        ", bottom right": BOTTOM_RIGHT,
        ", top left": TOP_LEFT,
        ", top right": TOP_RIGHT,
    }.items():
        for packed, plus in (("", 0), (", RLE", 8)):
            yield "24 bits" + label + packed, tga(2 + plus, 24, bgr(rgb), origin), scaled(rgb)
            yield "32 bits, 8 of alpha" + label + packed, tga(2 + plus, 32, bgr(rgba), origin, 8), scaled(rgba)
            yield (
                "8 bits of grey" + label + packed,
                tga(3 + plus, 8, [[bytes((int(v),)) for v in row] for row in grey[..., 0]], origin),
                scaled(grey),
            )
    yield "24 bits, with a name", tga(2, 24, bgr(rgb), name=b"a name of the picture"), scaled(rgb)
    for byte in (0, 9, 255):
        unused = numpy.concatenate([rgb, numpy.full(rgb.shape[:2] + (1,), byte)], -1)
        for packed, plus in (("", 0), (", RLE", 8)):
            # Programs write alpha without saying so; readers take the byte for alpha unless it is 0 everywhere.
            yield f"32 bits, none of alpha, byte {byte}{packed}", tga(2 + plus, 32, bgr(unused)), scaled(
                unused if byte else rgb
            )
            for kind, name in {
                NO_ALPHA: "no alpha",
                IGNORED: "undefined, ignored",
                RETAINED: "undefined, retained",
            }.items():
                yield (
                    f"32 bits, version 2, type {kind} ({name}), byte {byte}{packed}",
                    tga(2 + plus, 32, bgr(unused), attribute_bits=8, alpha_type=kind),
                    scaled(rgb),
                )
    multiplied = rgba.copy()
    multiplied[..., :3] = numpy.rint(rgba[..., :3] * rgba[..., 3:] / 255)
    for packed, plus in (("", 0), (", RLE", 8)):
        yield (
            f"32 bits, version 2, straight{packed}",
            tga(2 + plus, 32, bgr(rgba), attribute_bits=8, alpha_type=STRAIGHT),
            scaled(rgba),
        )
        yield (
            f"32 bits, version 2, premultiplied{packed}",
            tga(2 + plus, 32, bgr(multiplied), attribute_bits=8, alpha_type=MULTIPLIED),
            scaled(rgba),
        )
    clear = rgba.copy()
    clear[..., 3] = 0
    yield "32 bits, 8 of alpha, all clear", tga(2, 32, bgr(clear), attribute_bits=8), scaled(clear)
    for top in (0, 1):
        pixels, shown = words(scaled(rgb), numpy.full(rgb.shape[:2], top))
        yield f"16 bits, top bit {top}, none of alpha", tga(2, 16, pixels), shown
        yield f"16 bits, top bit {top}, none of alpha, RLE", tga(10, 16, pixels), shown
        yield f"15 bits, top bit {top}", tga(2, 15, pixels), shown
    y, x = numpy.mgrid[0:HEIGHT, 0:WIDTH]
    bit = (x + y) % 3 > 0
    pixels, shown = words(scaled(rgb), bit)
    yield "16 bits, 1 of alpha", tga(2, 16, pixels, attribute_bits=1), numpy.concatenate([shown, bit[..., None]], -1)
    grey_alpha = picture(2)
    yield (
        "16 bits of grey and alpha",
        tga(3, 16, [[bytes(int(v) for v in pixel) for pixel in row] for row in grey_alpha], attribute_bits=8),
        scaled(grey_alpha),
    )
    for colours, first in ((256, 0), (100, 0), (50, 16)):
        palette, indices = indexed(colours)
        rows = [[bytes((int(v) + first,)) for v in row] for row in indices]
        entries = [bytes(int(v) for v in entry[::-1]) for entry in palette]
        for packed, kind in (("", 1), (", RLE", 9)):
            yield (
                f"palette of {colours} from {first}, 24 bits{packed}",
                tga(kind, 8, rows, palette=entries, palette_bits=24, first=first),
                scaled(palette[indices]),
            )
    palette, indices = indexed(256, 4)
    rows = [[bytes((int(v),)) for v in row] for row in indices]
    entries = [bytes(int(v) for v in entry[[2, 1, 0, 3]]) for entry in palette]
    yield (
        "palette of 256, 32 bits, 8 of alpha",
        tga(1, 8, rows, palette=entries, palette_bits=32, attribute_bits=8),
        scaled(palette[indices]),
    )
    five = palette[:, :3] >> 3
    entries = [struct.pack("<H", r << 10 | g << 5 | b) for r, g, b in five.tolist()]
    for bits in (15, 16):
        yield f"palette of 256, {bits} bits", tga(1, 8, rows, palette=entries, palette_bits=bits), five[indices] / 31
    index16 = [[struct.pack("<H", int(v)) for v in row] for row in indices]
    entries = [bytes(int(v) for v in entry[:3][::-1]) for entry in palette]
    yield "palette of 256, indices of 16 bits", tga(1, 16, index16, palette=entries, palette_bits=24), scaled(
        palette[indices][..., :3]
    )


def samples():
    for variant, data, expected in by_hand():
        yield Sample("TGA", variant, "bytes", ".tga", data, expected)
