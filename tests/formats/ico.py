"""ICO: bitmaps of all depths with their masks, PNG, several sizes."""

import struct

import numpy

from bmp import packed_indices, palette_bytes, rows_of
from picture import Sample, indexed, picture, scaled

W, H = 33, 18


def png(samples, levels=255):
    import io

    from PIL import Image

    out = io.BytesIO()
    Image.fromarray(samples.astype("u1")).save(out, "PNG")
    return out.getvalue()


def bitmap(bits, pixels, mask, palette=b"", colours=0):
    """A bitmap of an icon: twice its height, with a mask of 1 where it is transparent."""
    and_mask = rows_of(packed_indices(mask.astype(int), 1), False)
    return struct.pack("<IiiHHIIiiII", 40, W, 2 * H, 1, bits, 0, 0, 0, 0, colours, 0) + palette + pixels + and_mask


def ico(images, kind=1):
    """`images` are (width, height, bits, bytes)."""
    out, at = struct.pack("<HHH", 0, kind, len(images)), 6 + 16 * len(images)
    for width, height, bits, data in images:
        out += struct.pack("<BBBBHHII", width % 256, height % 256, 0, 0, 1, bits, len(data), at)
        at += len(data)
    return out + b"".join(data for *_, data in images)


def by_hand():
    y, x = numpy.mgrid[0:H, 0:W]
    mask = (x + 2 * y) % 5 == 0
    rgb, rgba = picture(3, 255, W, H), picture(4, 255, W, H)
    opaque = numpy.where(mask, 0, 1)[..., None]
    for label, clear in (("", mask), (", no pixel transparent", mask & False)):
        cover = numpy.where(clear, 0, 1)[..., None]
        rows = rows_of([row[:, ::-1].astype("u1").tobytes() for row in rgb], False)
        yield "24 bits" + label, ico([(W, H, 24, bitmap(24, rows, clear))]), numpy.concatenate([scaled(rgb), cover], -1)
        for bits in (1, 4, 8):
            palette, indices = indexed(2**bits, width=W, height=H)
            data = bitmap(bits, rows_of(packed_indices(indices, bits), False), clear, palette_bytes(palette))
            yield f"{bits} bits{label}", ico([(W, H, bits, data)]), numpy.concatenate(
                [scaled(palette[indices]), cover], -1
            )
    rows = rows_of([row[:, [2, 1, 0, 3]].astype("u1").tobytes() for row in rgba], False)
    yield "32 bits, alpha", ico([(W, H, 32, bitmap(32, rows, mask & False))]), scaled(rgba)
    unused = numpy.concatenate([rgb, 0 * rgb[..., :1]], -1)
    rows = rows_of([row[:, [2, 1, 0, 3]].astype("u1").tobytes() for row in unused], False)
    yield "32 bits, alpha 0 everywhere", ico([(W, H, 32, bitmap(32, rows, mask))]), numpy.concatenate(
        [scaled(rgb), opaque], -1
    )
    yield "PNG, RGBA", ico([(W, H, 32, png(rgba))]), scaled(rgba)
    yield "PNG, RGB", ico([(W, H, 24, png(rgb))]), scaled(rgb)
    yield "PNG, grey", ico([(W, H, 8, png(picture(1, 255, W, H)[..., 0]))]), scaled(picture(1, 255, W, H))
    small = picture(4, 255, 16, 16)
    yield "two sizes, the larger last", ico([(16, 16, 32, png(small)), (W, H, 32, png(rgba))]), scaled(rgba)
    yield "two sizes, the larger first", ico([(W, H, 32, png(rgba)), (16, 16, 32, png(small))]), scaled(rgba)
    yield "a cursor", ico([(W, H, 0, png(rgba))], kind=2), scaled(rgba)


def samples():
    for variant, data, expected in by_hand():
        yield Sample("ICO", variant, "bytes", ".cur" if variant == "a cursor" else ".ico", data, expected)
