"""GIF: tables of colours, transparency, windows in a larger canvas, interlacing, several frames."""

import io
import struct

import numpy

from picture import HEIGHT, WIDTH, Sample, indexed, scaled


def lzw(indices, bits):
    """Codes of one more bit than the indices, without compression: a clear code before the table grows."""
    clear, size = 1 << bits, bits + 1
    codes = []
    for i, value in enumerate(indices):
        if i % ((1 << bits) - 2) == 0:
            codes.append(clear)
        codes.append(int(value))
    codes.append(clear + 1)
    number, shift, out = 0, 0, bytearray()
    for code in codes:
        number |= code << shift
        shift += size
        while shift >= 8:
            out.append(number & 255)
            number >>= 8
            shift -= 8
    out.append(number & 255)
    blocks = b"".join(bytes((len(out[i : i + 255]),)) + bytes(out[i : i + 255]) for i in range(0, len(out), 255))
    return bytes((bits,)) + blocks + b"\0"


def frame(indices, bits, at=(0, 0), table=b"", clear=None, interlaced=False, disposal=0):
    height, width = indices.shape
    rows = (
        [y for start, step in ((0, 8), (4, 8), (2, 4), (1, 2)) for y in range(start, height, step)]
        if interlaced
        else range(height)
    )
    data = numpy.concatenate([indices[y] for y in rows])
    control = b"\x21\xf9\x04" + struct.pack("<BHBB", disposal << 2 | (clear is not None), 0, clear or 0, 0)
    flags = (0x80 | (bits - 1) if table else 0) | (0x40 if interlaced else 0)
    return control + b"\x2c" + struct.pack("<HHHHB", *at, width, height, flags) + table + lzw(data, bits)


def gif(frames, bits, table=b"", background=0, width=WIDTH, height=HEIGHT):
    flags = 0x80 | (bits - 1) if table else 0
    return b"GIF89a" + struct.pack("<HHBBB", width, height, flags, background, 0) + table + b"".join(frames) + b"\x3b"


def by_hand():
    for bits in (2, 4, 8):
        palette, indices = indexed(2**bits)
        table = palette.astype("u1").tobytes()
        shown = scaled(palette[indices])
        yield f"global table of {2 ** bits}", gif([frame(indices, bits)], bits, table), shown
        yield f"local table of {2 ** bits}", gif([frame(indices, bits, table=table)], bits), shown
        yield f"table of {2 ** bits}, interlaced", gif([frame(indices, bits, interlaced=True)], bits, table), shown
        for clear in (0, 2):
            alpha = (indices != clear)[..., None].astype(float)
            yield (
                f"table of {2 ** bits}, index {clear} transparent",
                gif([frame(indices, bits, clear=clear)], bits, table),
                numpy.concatenate([shown, alpha], -1),
            )
    palette, indices = indexed(16)
    table = palette.astype("u1").tobytes()
    grey = numpy.arange(16)[:, None].repeat(3, 1) * 17
    yield "a table of greys", gif([frame(indices, 4)], 4, grey.astype("u1").tobytes()), scaled(grey[indices])
    inner = indices[3:15, 5:30]
    shown = numpy.zeros((HEIGHT, WIDTH, 4))
    shown[3:15, 5:30, :3] = scaled(palette[inner])
    shown[3:15, 5:30, 3] = 1
    yield "a window in a larger canvas", gif([frame(inner, 4, at=(5, 3))], 4, table), shown
    yield "a window, background 3", gif([frame(inner, 4, at=(5, 3))], 4, table, background=3), shown
    yield "three frames", gif([frame(indices, 4), frame(15 - indices, 4), frame(indices, 4)], 4, table), scaled(
        palette[indices]
    )
    yield "two frames, the second a window", gif([frame(indices, 4), frame(inner, 4, at=(1, 1))], 4, table), scaled(
        palette[indices]
    )


def samples():
    from PIL import Image

    for variant, data, expected in by_hand():
        yield Sample("GIF", variant, "bytes", ".gif", data, expected)
    palette, indices = indexed(200)
    image = Image.fromarray(indices.astype("u1"), "P")
    image.putpalette(palette.astype("u1").tobytes())
    for interlace in (0, 1):
        out = io.BytesIO()
        image.save(out, "GIF", interlace=interlace)
        yield Sample(
            "GIF", f"palette, interlace {interlace}", "Pillow", ".gif", out.getvalue(), scaled(palette[indices])
        )
    out = io.BytesIO()
    image.save(out, "GIF", transparency=7)
    shown = numpy.concatenate([scaled(palette[indices]), (indices != 7)[..., None]], -1)
    yield Sample("GIF", "palette, transparency", "Pillow", ".gif", out.getvalue(), shown)
    out = io.BytesIO()
    Image.fromarray((indices % 256).astype("u1"), "L").save(out, "GIF")
    yield Sample("GIF", "grey", "Pillow", ".gif", out.getvalue(), scaled(indices)[..., None])
