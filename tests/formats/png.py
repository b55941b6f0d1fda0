"""PNG: by hand in all colour types, depths, transparent colours and interlacing, and by libraries."""

import io
import struct
import zlib

import numpy

from picture import Sample, indexed, picture, scaled

GREY, RGB, PALETTE, GREY_ALPHA, RGBA = 0, 2, 3, 4, 6
ADAM7 = ((0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2))


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def raw_rows(values, depth):
    out = b""
    for row in values.reshape(values.shape[0], -1):
        if depth == 16:
            data = row.astype(">u2").tobytes()
        elif depth == 8:
            data = row.astype("u1").tobytes()
        else:
            text = "".join(f"{int(v):0{depth}b}" for v in row)
            text += "0" * (-len(text) % 8)
            data = bytes(int(text[i : i + 8], 2) for i in range(0, len(text), 8))
        out += b"\0" + data
    return out


def png(values, colour_type, depth, chunks=(), interlaced=False):
    height, width = values.shape[:2]
    head = struct.pack(">IIBBBBB", width, height, depth, colour_type, 0, 0, interlaced)
    if interlaced:
        passes = [values[y::dy, x::dx] for x, y, dx, dy in ADAM7]
        data = b"".join(raw_rows(p, depth) for p in passes if p.size)
    else:
        data = raw_rows(values, depth)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", head)
        + b"".join(chunk(*c) for c in chunks)
        + chunk(b"IDAT", zlib.compress(data))
        + chunk(b"IEND", b"")
    )


def by_hand():
    for interlaced in (False, True):
        name = ", interlaced" if interlaced else ""
        for depth in (1, 2, 4, 8, 16):
            peak = 2**depth - 1
            for colour_type, channels in {GREY: 1, RGB: 3, GREY_ALPHA: 2, RGBA: 4}.items():
                if depth < 8 and colour_type != GREY:
                    continue
                values = picture(channels, peak)
                yield f"{channels} channels, {depth} bits{name}", png(
                    values, colour_type, depth, interlaced=interlaced
                ), scaled(values, peak)
                if colour_type in (GREY, RGB):
                    clear = values[5, 7]
                    alpha = (values != clear).any(-1, keepdims=True)
                    data = png(values, colour_type, depth, [(b"tRNS", clear.astype(">u2").tobytes())], interlaced)
                    yield (
                        f"{channels} channels, {depth} bits, a transparent colour{name}",
                        data,
                        numpy.concatenate([scaled(values, peak), alpha], -1),
                    )
            if depth < 16:
                palette, indices = indexed(2**depth, 4)
                table = (b"PLTE", palette[:, :3].astype("u1").tobytes())
                yield f"palette, {depth} bits{name}", png(indices, PALETTE, depth, [table], interlaced), scaled(
                    palette[indices][..., :3]
                )
                clear = (b"tRNS", palette[:, 3].astype("u1").tobytes())
                yield f"palette and alpha, {depth} bits{name}", png(
                    indices, PALETTE, depth, [table, clear], interlaced
                ), scaled(palette[indices])
                short = (b"tRNS", palette[:2, 3].astype("u1").tobytes())
                shown = scaled(palette[indices])
                shown[..., 3] = numpy.where(indices < 2, shown[..., 3], 1)
                yield f"palette and alpha of two, {depth} bits{name}", png(
                    indices, PALETTE, depth, [table, short], interlaced
                ), shown
    values = picture(4)
    yield "a background", png(values, RGBA, 8, [(b"bKGD", b"\0\xff\0\0\0\0")]), scaled(values)
    yield "significant bits", png(values, RGBA, 8, [(b"sBIT", b"\5\5\5\5")]), scaled(values)


def samples():
    import cv2
    from PIL import Image

    for variant, data, expected in by_hand():
        yield Sample("PNG", variant, "bytes", ".png", data, expected)
    for mode, channels, peak in (("L", 1, 255), ("LA", 2, 255), ("RGB", 3, 255), ("RGBA", 4, 255), ("I;16", 1, 65535)):
        pixels = picture(channels, peak)
        out = io.BytesIO()
        Image.fromarray(pixels.astype("u2" if peak > 255 else "u1").squeeze()).save(out, "PNG")
        yield Sample("PNG", mode, "Pillow", ".png", out.getvalue(), scaled(pixels, peak))
    for channels in (1, 3, 4):
        for peak in (255, 65535):
            pixels = picture(channels, peak)
            data = cv2.imencode(
                ".png",
                pixels.astype("u2" if peak > 255 else "u1")[..., [2, 1, 0, 3][:channels] if channels > 2 else [0]],
            )[1].tobytes()
            yield Sample("PNG", f"{channels} channels, maximum {peak}", "OpenCV", ".png", data, scaled(pixels, peak))
