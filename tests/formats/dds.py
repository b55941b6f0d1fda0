"""DDS: uncompressed with masks, and block compression."""

import struct

import numpy

from picture import Sample, picture, scaled

REFUSED = r"luminance and alpha|, DX10"

ALPHA_PIXELS, ALPHA, FOURCC, RGB, LUMINANCE, YUV = 1, 2, 4, 0x40, 0x20000, 0x200
W, H = 36, 20


def dds(flags, bits=0, masks=(0, 0, 0, 0), data=b"", code=b"\0\0\0\0", dx10=b"", caps2=0):
    pixel = struct.pack("<II4sIIIII", 32, flags, code, bits, *masks)
    return (
        b"DDS "
        + struct.pack("<IIIIIII44x", 124, 0x1007, H, W, 0, 0, 1)
        + pixel
        + struct.pack("<IIIII", 0x1000, caps2, 0, 0, 0)
        + dx10
        + data
    )


def words(samples, masks, size):
    out = numpy.zeros(samples.shape[:2], numpy.int64)
    shown = []
    for c, mask in enumerate(masks[: samples.shape[2]]):
        low = (mask & -mask).bit_length() - 1
        peak = mask >> low
        value = numpy.rint(samples[..., c] * peak).astype(numpy.int64)
        out |= value << low
        shown.append(value / peak)
    return b"".join(int(v).to_bytes(size, "little") for v in out.ravel()), numpy.stack(shown, -1)


def colour_block(block, three_colours=False):
    """DXT1 of 4x4 pixels of one or two colours: exact for colours of 565."""
    flat = block.reshape(-1, 3)
    codes = flat[:, 0] << 11 | flat[:, 1] << 5 | flat[:, 2]
    c0, c1 = int(codes.max()), int(codes.min())
    bits = sum((0 if int(code) == c0 else 1) << (2 * i) for i, code in enumerate(codes))
    return struct.pack("<HHI", c0, c1, bits) if c0 != c1 else struct.pack("<HHI", c0, 0 if c0 else 0, 0)


def blocky(samples):
    """Each block of 4x4 pixels has one colour in 565, so that block compression is exact."""
    rough = samples[::4, ::4]
    five = numpy.stack(
        [numpy.rint(rough[..., 0] * 31), numpy.rint(rough[..., 1] * 63), numpy.rint(rough[..., 2] * 31)], -1
    ).astype(int)
    five[..., 2] |= 1  # never 0, so that the second colour is smaller
    return five, (five / [31, 63, 31]).repeat(4, 0).repeat(4, 1)


def by_hand():
    rgb, rgba, grey, grey_alpha = (scaled(picture(c, 255, W, H)) for c in (3, 4, 1, 2))
    for name, masks in {
        "BGRA": (0xFF0000, 0xFF00, 0xFF, 0xFF000000),
        "RGBA": (0xFF, 0xFF00, 0xFF0000, 0xFF000000),
    }.items():
        data, shown = words(rgba, masks, 4)
        yield f"32 bits, {name}", dds(RGB | ALPHA_PIXELS, 32, masks, data), shown
    masks = (0xFF0000, 0xFF00, 0xFF, 0)
    data, shown = words(rgb, masks, 4)
    yield "32 bits, BGRX", dds(RGB, 32, masks, data), shown
    data, shown = words(rgb, masks, 3)
    yield "24 bits, BGR", dds(RGB, 24, masks, data), shown
    for name, masks in {"565": (0xF800, 0x7E0, 0x1F, 0), "555": (0x7C00, 0x3E0, 0x1F, 0)}.items():
        data, shown = words(rgb, masks, 2)
        yield f"16 bits, {name}", dds(RGB, 16, masks, data), shown
    for name, masks in {"4444": (0xF00, 0xF0, 0xF, 0xF000), "1555": (0x7C00, 0x3E0, 0x1F, 0x8000)}.items():
        data, shown = words(rgba, masks, 2)
        yield f"16 bits, {name}", dds(RGB | ALPHA_PIXELS, 16, masks, data), shown
    data, shown = words(grey, (0xFF,), 1)
    yield "8 bits, luminance", dds(LUMINANCE, 8, (0xFF, 0, 0, 0), data), shown
    data, shown = words(grey_alpha, (0xFF, 0xFF00), 2)
    yield "16 bits, luminance and alpha", dds(LUMINANCE | ALPHA_PIXELS, 16, (0xFF, 0, 0, 0xFF00), data), shown
    five, shown = blocky(rgb)
    blocks = [struct.pack("<HHI", r << 11 | g << 5 | b, 0, 0) for row in five.tolist() for r, g, b in row]
    yield "DXT1", dds(FOURCC, code=b"DXT1", data=b"".join(blocks)), shown
    alpha4 = numpy.rint(rgba[::4, ::4, 3] * 15).astype(int)
    nibbles = [bytes((a << 4 | a,)) * 8 for a in alpha4.ravel().tolist()]
    alpha_shown = (alpha4 / 15).repeat(4, 0).repeat(4, 1)[..., None]
    yield "DXT3", dds(FOURCC, code=b"DXT3", data=b"".join(a + b for a, b in zip(nibbles, blocks))), numpy.concatenate(
        [shown, alpha_shown], -1
    )
    alpha8 = numpy.rint(rgba[::4, ::4, 3] * 255).astype(int)
    fifths = [bytes((a, 0)) + bytes(6) for a in alpha8.ravel().tolist()]
    alpha_shown = (alpha8 / 255).repeat(4, 0).repeat(4, 1)[..., None]
    yield "DXT5", dds(FOURCC, code=b"DXT5", data=b"".join(a + b for a, b in zip(fifths, blocks))), numpy.concatenate(
        [shown, alpha_shown], -1
    )
    for code in (b"DXT2", b"DXT4"):  # colours multiplied by alpha
        light = shown * alpha_shown
        five2 = numpy.rint(light[::4, ::4] * [31, 63, 31]).astype(int)
        stored = (five2 / [31, 63, 31]).repeat(4, 0).repeat(4, 1)
        a4 = alpha4 if code == b"DXT2" else alpha8
        a_shown = (a4 / (15 if code == b"DXT2" else 255)).repeat(4, 0).repeat(4, 1)[..., None]
        blocks2 = [struct.pack("<HHI", r << 11 | g << 5 | b, 0, 0) for row in five2.tolist() for r, g, b in row]
        heads = nibbles if code == b"DXT2" else fifths
        yield (
            code.decode(),
            dds(FOURCC, code=code, data=b"".join(a + b for a, b in zip(heads, blocks2))),
            numpy.concatenate([numpy.minimum(stored / a_shown, 1), a_shown], -1),
        )
    dx10 = struct.pack("<IIIII", 28, 3, 0, 1, 0)  # R8G8B8A8_UNORM
    yield "DX10, RGBA", dds(FOURCC, code=b"DX10", dx10=dx10, data=picture(4, 255, W, H).astype("u1").tobytes()), rgba


def samples():
    for variant, data, expected in by_hand():
        yield Sample("DDS", variant, "bytes", ".dds", data, expected, 2 / 255)
