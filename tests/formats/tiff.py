"""TIFF: by hand in its depths, kinds of samples, photometrics, planes, orders of bits and bytes, and by libraries."""

import io
import struct

import numpy

from picture import HEIGHT, WIDTH, Sample, indexed, picture, scaled

REFUSED = r" 24 bits|, (RGB|grey) and an unspecified|one more and straight|palette and alpha|LAB$|, CMYK without"

WHITE_IS_ZERO, BLACK_IS_ZERO, RGB, PALETTE, MASK, SEPARATED, YCBCR, CIELAB = 0, 1, 2, 3, 4, 5, 6, 8
UNSIGNED, SIGNED, FLOAT = 1, 2, 3
UNSPECIFIED, ASSOCIATED, UNASSOCIATED = 0, 1, 2
BYTE, SHORT, LONG, RATIONAL, LONG8 = 1, 3, 4, 5, 16


def tiff(tags, segments, order="<", big=False):
    """`tags` maps numbers to (type, values); `segments` are the strips, or tiles where there is tag 322."""
    offset_type, offset_code, inline = (LONG8, "Q", 8) if big else (LONG, "I", 4)
    header = 16 if big else 8
    tags = dict(tags)
    at, offsets = header, []
    for segment in segments:
        offsets.append(at)
        at += len(segment) + len(segment) % 2
    tiled = 322 in tags
    tags[324 if tiled else 273] = (offset_type, offsets)
    tags[325 if tiled else 279] = (LONG, [len(segment) for segment in segments])
    body = b"".join(segment + bytes(len(segment) % 2) for segment in segments)
    entries, extra = b"", b""
    extra_at = at + (8 if big else 2) + (20 if big else 12) * len(tags) + (8 if big else 4)
    for tag in sorted(tags):
        kind, values = tags[tag]
        values = list(values) if isinstance(values, (list, tuple, bytes, numpy.ndarray)) else [values]
        code = {BYTE: "B", SHORT: "H", LONG: "I", RATIONAL: "II", LONG8: "Q"}[kind]
        data = (
            b"".join(struct.pack(order + code, *v) for v in values)
            if kind == RATIONAL
            else struct.pack(f"{order}{len(values)}{code}", *values)
        )
        entries += struct.pack(order + "HH" + offset_code, tag, kind, len(values))
        if len(data) <= inline:
            entries += data.ljust(inline, b"\0")
        else:
            entries += struct.pack(order + offset_code, extra_at + len(extra))
            extra += data + bytes(len(data) % 2)
    mark = b"II" if order == "<" else b"MM"
    start = struct.pack(order + "HHHQ", 43, 8, 0, at) if big else struct.pack(order + "HI", 42, at)
    count = struct.pack(order + ("Q" if big else "H"), len(tags))
    return mark + start + body + count + entries + struct.pack(order + offset_code, 0) + extra


def packed(samples, bits, order="<", reverse=False):
    """Rows of unsigned integers (height, values of a row), each filled up to whole bytes."""
    out = []
    for row in samples:
        if bits in (8, 16, 32, 64):
            data = b"".join(int(v).to_bytes(bits // 8, "little" if order == "<" else "big") for v in row)
        elif bits == 24:
            data = b"".join(int(v).to_bytes(3, "little" if order == "<" else "big") for v in row)
        else:
            text = "".join(f"{int(v):0{bits}b}" for v in row)
            text += "0" * (-len(text) % 8)
            data = bytes(int(text[i : i + 8], 2) for i in range(0, len(text), 8))
        if reverse:
            data = bytes(int(f"{byte:08b}"[::-1], 2) for byte in data)
        out.append(data)
    return out


def interleaved(samples):
    return samples.reshape(samples.shape[0], -1)


def base_tags(channels, bits, photometric, extra=(), sample_format=UNSIGNED, **more):
    tags = {
        256: (LONG, WIDTH),
        257: (LONG, HEIGHT),
        258: (SHORT, [bits] * channels),
        259: (SHORT, 1),
        262: (SHORT, photometric),
        277: (SHORT, channels),
    }
    if extra:
        tags[338] = (SHORT, list(extra))
    if sample_format != UNSIGNED:
        tags[339] = (SHORT, [sample_format] * channels)
    for tag, value in more.items():
        tags[int(tag[1:])] = value
    return tags


def one_strip(tags, rows, order="<", big=False):
    return tiff({**tags, 278: (LONG, HEIGHT)}, [b"".join(rows)], order, big)


def strips(tags, rows, height, order="<"):
    return tiff(
        {**tags, 278: (LONG, height)}, [b"".join(rows[y : y + height]) for y in range(0, len(rows), height)], order
    )


def tiles(tags, samples, bits, size=16):
    """Samples of whole bytes."""
    full = numpy.zeros((-(-HEIGHT // size) * size, -(-WIDTH // size) * size) + samples.shape[2:], samples.dtype)
    full[:HEIGHT, :WIDTH] = samples
    segments = [
        b"".join(packed(interleaved(full[y : y + size, x : x + size]), bits))
        for y in range(0, full.shape[0], size)
        for x in range(0, full.shape[1], size)
    ]
    return tiff({**tags, 322: (SHORT, size), 323: (SHORT, size)}, segments)


def integers():
    """Depths and channels of unsigned samples, whatever zero is."""
    for bits in (1, 2, 4, 6, 8, 10, 12, 14, 16, 24, 32):
        peak = 2**bits - 1
        grey, grey_alpha = picture(1, peak), picture(2, peak)
        for order in "<>":
            name = f"{bits} bits" + (", big-endian" if order == ">" else "")
            yield f"grey, {name}", one_strip(
                base_tags(1, bits, BLACK_IS_ZERO), packed(interleaved(grey), bits, order), order
            ), scaled(grey, peak)
            yield (
                f"grey, white is zero, {name}",
                one_strip(base_tags(1, bits, WHITE_IS_ZERO), packed(interleaved(peak - grey), bits, order), order),
                scaled(grey, peak),
            )
        tags = base_tags(1, bits, BLACK_IS_ZERO, t266=(SHORT, 2))
        if bits <= 16:
            yield f"grey, {bits} bits, bits reversed", one_strip(
                tags, packed(interleaved(grey), bits, reverse=True)
            ), scaled(grey, peak)
        rgb, rgba = picture(3, peak), picture(4, peak)
        yield f"RGB, {bits} bits", one_strip(base_tags(3, bits, RGB), packed(interleaved(rgb), bits)), scaled(rgb, peak)
        if bits >= 8:
            for kind, extra in {"straight": UNASSOCIATED, "premultiplied": ASSOCIATED}.items():
                for shape, pixels, photometric in (
                    ("grey", grey_alpha, BLACK_IS_ZERO),
                    ("grey, white is zero", grey_alpha, WHITE_IS_ZERO),
                    ("RGB", rgba, RGB),
                ):
                    stored = pixels.astype(float)
                    if photometric == WHITE_IS_ZERO:
                        stored[..., 0] = peak - stored[..., 0]
                    if extra == ASSOCIATED:
                        stored[..., :-1] *= stored[..., -1:] / peak
                        if photometric == WHITE_IS_ZERO:
                            continue  # what premultiplied white-is-zero means is open
                    channels = pixels.shape[2]
                    yield (
                        f"{shape}, {kind} alpha, {bits} bits",
                        one_strip(
                            base_tags(channels, bits, photometric, (extra,)),
                            packed(interleaved(numpy.rint(stored)), bits),
                        ),
                        scaled(pixels, peak),
                    )


def layouts():
    rgb, rgba, grey = picture(3), picture(4), picture(1)
    for name, pixels, photometric, extra in (
        ("grey", grey, BLACK_IS_ZERO, ()),
        ("RGB", rgb, RGB, ()),
        ("RGBA", rgba, RGB, (UNASSOCIATED,)),
    ):
        channels = pixels.shape[2]
        tags = base_tags(channels, 8, photometric, extra)
        rows = packed(interleaved(pixels), 8)
        yield f"{name}, strips of 4", strips(tags, rows, 4), scaled(pixels)
        yield f"{name}, strips of 1", strips(tags, rows, 1), scaled(pixels)
        yield f"{name}, tiles", tiles(tags, pixels, 8), scaled(pixels)
        yield f"{name}, BigTIFF", one_strip(tags, rows, big=True), scaled(pixels)
        yield f"{name}, BigTIFF, big-endian", one_strip(tags, rows, ">", big=True), scaled(pixels)
        planes = [b"".join(packed(pixels[..., c], 8)) for c in range(channels)]
        yield f"{name}, planes", tiff({**tags, 284: (SHORT, 2), 278: (LONG, HEIGHT)}, planes), scaled(pixels)
        high = picture(channels, 65535)
        planes = [b"".join(packed(high[..., c], 16)) for c in range(channels)]
        yield (
            f"{name}, planes, 16 bits",
            tiff({**base_tags(channels, 16, photometric, extra), 284: (SHORT, 2), 278: (LONG, HEIGHT)}, planes),
            scaled(high, 65535),
        )
        yield f"{name}, tiles, 16 bits", tiles(base_tags(channels, 16, photometric, extra), high, 16), scaled(
            high, 65535
        )
    inverse = 255 - grey
    yield "grey, white is zero, tiles", tiles(base_tags(1, 8, WHITE_IS_ZERO), inverse, 8), scaled(grey)
    high = picture(1, 65535)
    yield "grey, white is zero, tiles, 16 bits", tiles(base_tags(1, 16, WHITE_IS_ZERO), 65535 - high, 16), scaled(
        high, 65535
    )
    high = picture(2, 65535)
    stored = [b"".join(packed(65535 - high[..., 0], 16)), b"".join(packed(high[..., 1], 16))]
    yield (
        "grey, white is zero, straight alpha, planes, 16 bits",
        tiff({**base_tags(2, 16, WHITE_IS_ZERO, (UNASSOCIATED,)), 284: (SHORT, 2), 278: (LONG, HEIGHT)}, stored),
        scaled(high, 65535),
    )


def extras():
    rgb, rgba = picture(3), picture(4)
    rows = packed(interleaved(rgba), 8)
    yield "RGB and an unspecified sample", one_strip(base_tags(4, 8, RGB, (UNSPECIFIED,)), rows), scaled(rgb)
    yield "RGB and four samples without a word", one_strip(base_tags(4, 8, RGB), rows), scaled(rgba)
    five = numpy.concatenate([rgba, 255 - rgba[..., 3:]], -1)
    rows = packed(interleaved(five), 8)
    yield "RGB, straight alpha and one more", one_strip(
        base_tags(5, 8, RGB, (UNASSOCIATED, UNSPECIFIED)), rows
    ), scaled(rgba)
    swapped = five[..., [0, 1, 2, 4, 3]]
    yield "RGB, one more and straight alpha", one_strip(
        base_tags(5, 8, RGB, (UNSPECIFIED, UNASSOCIATED)), packed(interleaved(swapped), 8)
    ), scaled(rgba)
    grey = picture(2)
    yield "grey and an unspecified sample", one_strip(
        base_tags(2, 8, BLACK_IS_ZERO, (UNSPECIFIED,)), packed(interleaved(grey), 8)
    ), scaled(grey[..., :1])


def palettes():
    for bits in (1, 2, 4, 8):
        palette, indices = indexed(2**bits)
        table = (palette * 257).T.reshape(-1)
        tags = base_tags(1, bits, PALETTE, t320=(SHORT, table))
        yield f"palette, {bits} bits", one_strip(tags, packed(indices, bits)), scaled(palette[indices])
        short = one_strip(base_tags(1, bits, PALETTE, t320=(SHORT, palette.T.reshape(-1))), packed(indices, bits))
        yield f"palette of 8 bits an entry, {bits} bits", short, scaled(palette[indices])
    palette, indices = indexed(256)
    alpha = numpy.rint(scaled(picture(2))[..., 1:] * 255).astype(int)
    tags = base_tags(2, 8, PALETTE, (UNASSOCIATED,), t320=(SHORT, (palette * 257).T.reshape(-1)))
    yield (
        "palette and alpha",
        one_strip(tags, packed(interleaved(numpy.concatenate([indices[..., None], alpha], -1)), 8)),
        numpy.concatenate([scaled(palette[indices]), scaled(alpha)], -1),
    )


def signed_and_floating():
    for bits in (8, 16, 32):
        peak = 2 ** (bits - 1) - 1
        for channels, photometric in ((1, BLACK_IS_ZERO), (3, RGB)):
            pixels = picture(channels, peak)
            yield (
                f"{'grey' if channels == 1 else 'RGB'}, signed {bits} bits",
                one_strip(
                    base_tags(channels, bits, photometric, sample_format=SIGNED), packed(interleaved(pixels), bits)
                ),
                scaled(pixels, peak),
            )
    for bits, kind in ((16, "<f2"), (32, "<f4"), (64, "<f8")):
        for channels, photometric, extra in (
            (1, BLACK_IS_ZERO, ()),
            (1, WHITE_IS_ZERO, ()),
            (2, BLACK_IS_ZERO, (2,)),
            (3, RGB, ()),
            (4, RGB, (2,)),
            (4, RGB, (1,)),
        ):
            pixels = scaled(picture(channels, 60000), 60000)
            stored = pixels.copy()
            if photometric == WHITE_IS_ZERO:
                stored = 1 - stored
            if extra == (1,):
                stored[..., :-1] *= stored[..., -1:]
            rows = [row.tobytes() for row in stored.astype(kind)]
            name = {1: "grey", 2: "grey and alpha", 3: "RGB", 4: "RGBA"}[channels] + (
                ", white is zero" if photometric == 0 else ""
            )
            name += ", premultiplied" if extra == (1,) else ""
            yield f"{name}, floating, {bits} bits", one_strip(
                base_tags(channels, bits, photometric, extra, FLOAT), rows
            ), pixels


def orientations():
    from PIL import Image  # only to turn

    pixels = picture(3).astype("u1")
    image = Image.fromarray(pixels)
    T = Image.Transpose
    inverse = {
        2: T.FLIP_LEFT_RIGHT,
        3: T.ROTATE_180,
        4: T.FLIP_TOP_BOTTOM,
        5: T.TRANSPOSE,
        6: T.ROTATE_90,
        7: T.TRANSVERSE,
        8: T.ROTATE_270,
    }
    for orientation, turn in inverse.items():
        turned = numpy.asarray(image.transpose(turn)).astype(int)
        tags = base_tags(3, 8, RGB, t274=(SHORT, orientation))
        tags[256], tags[257] = (LONG, turned.shape[1]), (LONG, turned.shape[0])
        yield (
            f"orientation {orientation}",
            tiff({**tags, 278: (LONG, turned.shape[0])}, [turned.astype("u1").tobytes()]),
            scaled(pixels),
        )


def subsampled():
    """YCbCr without compression, 4:4:4 and 4:2:0, of full range."""
    rgb = picture(3).astype(float)
    y = rgb @ [0.299, 0.587, 0.114]
    cb = (rgb[..., 2] - y) / 1.772 + 128
    cr = (rgb[..., 0] - y) / 1.402 + 128
    ycc = numpy.rint(numpy.stack([y, cb, cr], -1))
    more = {
        "t529": (RATIONAL, [(299, 1000), (587, 1000), (114, 1000)]),
        "t532": (RATIONAL, [(v, 1) for v in (0, 255, 128, 255, 128, 255)]),
    }
    yield "YCbCr 4:4:4", one_strip(
        base_tags(3, 8, YCBCR, t530=(SHORT, [1, 1]), **more), packed(interleaved(ycc), 8)
    ), rgb / 255, 2.5 / 255
    rows = []
    padded = numpy.pad(ycc, ((0, HEIGHT % 2), (0, WIDTH % 2), (0, 0)), mode="edge")
    for top in range(0, padded.shape[0], 2):
        row = b""
        for left in range(0, padded.shape[1], 2):
            block = padded[top : top + 2, left : left + 2]
            row += bytes(int(v) for v in block[..., 0].ravel()) + bytes(
                (int(block[..., 1].mean()), int(block[..., 2].mean()))
            )
        rows.append(row)
    yield "YCbCr 4:2:0", one_strip(base_tags(3, 8, YCBCR, t530=(SHORT, [2, 2]), **more), rows), rgb / 255, 12 / 255


def lab():
    rgb = picture(3)
    yield "CIELAB", one_strip(base_tags(3, 8, CIELAB), packed(interleaved(rgb), 8)), None
    yield "ICCLAB", one_strip(base_tags(3, 8, 9), packed(interleaved(rgb), 8)), None
    yield "CMYK without a profile", one_strip(base_tags(4, 8, SEPARATED), packed(interleaved(picture(4)), 8)), None


def by_tifffile():
    import tifffile

    for compression in ("lzw", "deflate", "zstd", "packbits", "lzma"):
        for predictor in (False, True):
            if predictor and compression == "packbits":
                continue
            for kind, levels in (("u1", 255), ("u2", 65535), ("f4", None)):
                if kind == "f4" and predictor:
                    continue
                for channels, photometric in ((1, "minisblack"), (1, "miniswhite"), (3, "rgb"), (4, "rgb")):
                    pixels = picture(channels, levels or 60000)
                    shown = scaled(pixels, levels or 60000)
                    stored = (shown if kind == "f4" else pixels).astype(kind)
                    if photometric == "miniswhite":
                        stored = (1 - stored) if kind == "f4" else (levels - stored).astype(kind)
                    out = io.BytesIO()
                    tifffile.imwrite(
                        out,
                        stored[..., 0] if channels == 1 else stored,
                        photometric=photometric,
                        compression=compression,
                        predictor=predictor,
                        extrasamples=["unassalpha"] if channels == 4 else None,
                    )
                    yield f"{compression}{', predictor' if predictor else ''}, {kind}, {channels} channels, {photometric}", out.getvalue(), shown


def samples():
    for part in (integers, layouts, extras, palettes, signed_and_floating, orientations, subsampled, lab):
        for variant, data, expected, *tolerance in part():
            yield Sample("TIFF", variant, "bytes", ".tif", data, expected, *tolerance)
    for variant, data, expected in by_tifffile():
        yield Sample("TIFF", variant, "tifffile", ".tif", data, expected)
