"""BMP: by hand in all its headers, masks, palettes and compressions, and by libraries."""

import struct

import numpy

from picture import HEIGHT, WIDTH, Sample, indexed, picture, scaled

# Variants that OpenImageIO reads wrongly, and gscl refuses.
REFUSED = r", RLE|masks (4444|1555|of 10 bits|RGBX)|alpha mask.* RGBA"

RGB, RLE8, RLE4, BITFIELDS = 0, 1, 2, 3
CORE, INFO, V2, V3, V4, V5 = 12, 40, 52, 56, 108, 124


def rows_of(samples, top_down):
    """Rows of bytes, each filled up to a multiple of 4, from the bottom upwards unless top-down."""
    rows = [bytes(row) + bytes(-len(row) % 4) for row in samples]
    return b"".join(rows if top_down else rows[::-1])


def packed_indices(indices, bits):
    per_byte = 8 // bits
    out = []
    for row in indices:
        row = list(row) + [0] * (-len(row) % per_byte)
        out.append(
            bytes(
                sum(int(v) << (8 - bits * (i + 1)) for i, v in enumerate(row[at : at + per_byte]))
                for at in range(0, len(row), per_byte)
            )
        )
    return out


def bmp(
    header, bits, pixels, compression=RGB, masks=(), palette=b"", top_down=False, colours=0, width=WIDTH, height=HEIGHT
):
    """`masks` are those of red, green, blue and perhaps alpha.  They lie in headers of 52 bytes and more, else behind it."""
    if header == CORE:
        dib = struct.pack("<IHHHH", CORE, width, height, 1, bits)
    else:
        dib = struct.pack(
            "<IiiHHIIiiII",
            header,
            width,
            -height if top_down else height,
            1,
            bits,
            compression,
            len(pixels),
            2835,
            2835,
            colours,
            0,
        )
    inside = b"".join(struct.pack("<I", m) for m in masks)
    room = 12 if header == V2 else 16
    if header >= V2:
        dib += inside[:room].ljust(room, b"\0")
        dib += (b"BGRs" + bytes(header - len(dib) - 4)) if header >= V4 else b""
        inside = b""
    offset = 14 + len(dib) + len(inside) + len(palette)
    return b"BM" + struct.pack("<IHHI", offset + len(pixels), 0, 0, offset) + dib + inside + palette + pixels


def words(values, size):
    return [b"".join(int(v).to_bytes(size, "little") for v in row) for row in values]


def masked(samples, masks):
    """Samples of 0..1 as words whose bits the masks name."""
    out = numpy.zeros(samples.shape[:2], dtype=numpy.int64)
    for c, mask in enumerate(masks):
        if mask:
            shift = (mask & -mask).bit_length() - 1
            out |= numpy.rint(samples[..., c] * (mask >> shift)).astype(numpy.int64) << shift
    return out


def quantised(samples, masks):
    """What is left of samples in these bits."""
    peaks = [mask >> (mask & -mask).bit_length() - 1 for mask in masks if mask]
    return numpy.stack([numpy.rint(samples[..., c] * peak) / peak for c, peak in enumerate(peaks)], -1)


def rle8(indices):
    out = b""
    for row in indices[::-1]:
        x = 0
        while x < len(row):
            n = min(200, len(row) - x) if x % 2 else 1
            run = bytes(int(v) for v in row[x : x + n])
            out += bytes((1, run[0])) if n < 3 else bytes((0, n)) + run + bytes(n % 2)
            x += n
        out += b"\0\0"
    return out + b"\0\1"


def rle4(indices):
    out = b""
    for row in indices[::-1]:
        x, row = 0, [int(v) for v in row]
        while x < len(row):
            pair = row[x : x + 2] + [0] * (2 - len(row[x : x + 2]))
            out += bytes((min(2, len(row) - x), pair[0] << 4 | pair[1]))
            x += 2
        out += b"\0\0"
    return out + b"\0\1"


def palette_bytes(palette, size=4):
    return b"".join(bytes((int(b), int(g), int(r)) + (0,) * (size - 3)) for r, g, b in palette)


def by_hand():
    rgb, rgba = scaled(picture(3)), scaled(picture(4))
    bgr = [row[:, ::-1].astype("u1").tobytes() for row in picture(3)]
    yield "24 bits", bmp(INFO, 24, rows_of(bgr, False)), rgb
    yield "24 bits, top-down", bmp(INFO, 24, rows_of(bgr, True), top_down=True), rgb
    yield "24 bits, OS/2 header", bmp(CORE, 24, rows_of(bgr, False)), rgb
    yield "24 bits, V4", bmp(V4, 24, rows_of(bgr, False)), rgb
    yield "24 bits, V5", bmp(V5, 24, rows_of(bgr, False)), rgb
    for bits in (1, 4, 8):
        palette, indices = indexed(2**bits)
        shown = scaled(palette[indices])
        rows = rows_of(packed_indices(indices, bits), False)
        yield f"palette of {2 ** bits}", bmp(INFO, bits, rows, palette=palette_bytes(palette)), shown
        yield f"palette of {2 ** bits}, OS/2 header", bmp(CORE, bits, rows, palette=palette_bytes(palette, 3)), shown
        yield f"palette of {2 ** bits}, V5", bmp(V5, bits, rows, palette=palette_bytes(palette)), shown
        yield (
            f"palette of {2 ** bits}, top-down",
            bmp(
                INFO, bits, rows_of(packed_indices(indices, bits), True), palette=palette_bytes(palette), top_down=True
            ),
            shown,
        )
    palette, indices = indexed(11)
    yield (
        "palette of 11, 8 bits",
        bmp(INFO, 8, rows_of(packed_indices(indices, 8), False), palette=palette_bytes(palette), colours=11),
        scaled(palette[indices]),
    )
    yield (
        "palette of 11, 4 bits",
        bmp(INFO, 4, rows_of(packed_indices(indices, 4), False), palette=palette_bytes(palette), colours=11),
        scaled(palette[indices]),
    )
    grey = numpy.arange(256)[:, None].repeat(3, 1)
    values = picture(1)[..., 0]
    yield "palette of greys", bmp(
        INFO, 8, rows_of(packed_indices(values, 8), False), palette=palette_bytes(grey)
    ), scaled(picture(1))
    palette, indices = indexed(256)
    yield "RLE8", bmp(INFO, 8, rle8(indices), RLE8, palette=palette_bytes(palette)), scaled(palette[indices])
    palette, indices = indexed(16)
    yield "RLE4", bmp(INFO, 4, rle4(indices), RLE4, palette=palette_bytes(palette)), scaled(palette[indices])
    five = (0x7C00, 0x3E0, 0x1F)
    six = (0xF800, 0x7E0, 0x1F)
    yield "16 bits", bmp(INFO, 16, rows_of(words(masked(rgb, five), 2), False)), quantised(rgb, five)
    for name, header in {"INFO": INFO, "V2": V2, "V3": V3, "V4": V4, "V5": V5}.items():
        yield (
            f"16 bits, masks 565, {name}",
            bmp(header, 16, rows_of(words(masked(rgb, six), 2), False), BITFIELDS, six),
            quantised(rgb, six),
        )
    four = (0xF00, 0xF0, 0xF, 0xF000)
    yield (
        "16 bits, masks 4444, V5",
        bmp(V5, 16, rows_of(words(masked(rgba, four), 2), False), BITFIELDS, four),
        quantised(rgba, four),
    )
    five_alpha = (0x7C00, 0x3E0, 0x1F, 0x8000)
    cut = rgba.copy()
    cut[..., 3] = numpy.rint(rgba[..., 3])
    yield (
        "16 bits, masks 1555, V5",
        bmp(V5, 16, rows_of(words(masked(cut, five_alpha), 2), False), BITFIELDS, five_alpha),
        quantised(cut, five_alpha),
    )
    usual = (0xFF0000, 0xFF00, 0xFF)
    for byte in (0, 7, 255):
        values = masked(rgb, usual) | byte << 24
        rows, down = rows_of(words(values, 4), False), rows_of(words(values, 4), True)
        for name, header in {"INFO": INFO, "V3": V3, "V4": V4, "V5": V5}.items():
            yield f"32 bits, unused byte {byte}, {name}", bmp(header, 32, rows), rgb
            yield f"32 bits, unused byte {byte}, {name}, top-down", bmp(header, 32, down, top_down=True), rgb
            yield (
                f"32 bits, masks, unused byte {byte}, {name}",
                bmp(header, 32, rows, BITFIELDS, usual + (0,) * (header > INFO)),
                rgb,
            )
    with_alpha = (0xFF0000, 0xFF00, 0xFF, 0xFF000000)
    other = (0xFF, 0xFF00, 0xFF0000, 0xFF000000)
    ten = (0x3FF00000, 0xFFC00, 0x3FF)
    for name, header in {"V3": V3, "V4": V4, "V5": V5}.items():
        for order, masks in {"BGRA": with_alpha, "RGBA": other}.items():
            yield (
                f"32 bits, alpha mask, {order}, {name}",
                bmp(header, 32, rows_of(words(masked(rgba, masks), 4), False), BITFIELDS, masks),
                rgba,
            )
            clear = rgba * 1.0
            clear[..., 3] = 0
            yield (
                f"32 bits, alpha mask, all clear, {order}, {name}",
                bmp(header, 32, rows_of(words(masked(clear, masks), 4), False), BITFIELDS, masks),
                clear,
            )
        yield (
            f"32 bits, masks of 10 bits, {name}",
            bmp(header, 32, rows_of(words(masked(rgb, ten), 4), False), BITFIELDS, ten + (0,)),
            quantised(rgb, ten),
        )
    first = (0xFF000000, 0xFF0000, 0xFF00, 0xFF)
    yield (
        "32 bits, masks RGBX, INFO",
        bmp(INFO, 32, rows_of(words(masked(rgb, first[:3]), 4), False), BITFIELDS, first[:3]),
        rgb,
    )


def samples():
    for variant, data, expected in by_hand():
        yield Sample("BMP", variant, "bytes", ".bmp", data, expected)
