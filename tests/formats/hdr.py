"""Radiance HDR: its packings, the order of its rows and columns, exposure."""

import numpy

from picture import HEIGHT, WIDTH, Sample, linear_to_srgb, picture, scaled

REFUSED = r", gamma|, XYZE"


def rgbe(linear):
    peak = linear.max(-1)
    exponent = numpy.ceil(numpy.log2(numpy.maximum(peak, 1e-30)))
    exponent += peak >= 2.0**exponent * (255.5 / 256)
    mantissa = numpy.minimum(linear / 2.0 ** exponent[..., None] * 256, 255).astype(int)
    return numpy.concatenate([mantissa, exponent[..., None].astype(int) + 128], -1)


def unpacked(codes):
    return codes[..., :3] / 256 * 2.0 ** (codes[..., 3:] - 128.0)


def rle(codes):
    out = b""
    for row in codes:
        out += bytes((2, 2, row.shape[0] >> 8, row.shape[0] & 255))
        for c in range(4):
            values = bytes(int(v) for v in row[:, c])
            out += b"".join(
                bytes((len(values[i : i + 100]),)) + values[i : i + 100] for i in range(0, len(values), 100)
            )
    return out


def samples():
    linear = scaled(picture(3)) ** 2.2
    codes = rgbe(linear)
    shown = linear_to_srgb(unpacked(codes))
    head = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n"
    size = f"\n-Y {HEIGHT} +X {WIDTH}\n".encode()
    tolerance = 2.5 / 255
    yield Sample("HDR", "flat", "bytes", ".hdr", head + size + codes.astype("u1").tobytes(), shown, tolerance)
    yield Sample("HDR", "packed", "bytes", ".hdr", head + size + rle(codes), shown, tolerance)
    yield Sample(
        "HDR", "magic #?RGBE", "bytes", ".hdr", head.replace(b"RADIANCE", b"RGBE") + size + rle(codes), shown, tolerance
    )
    yield Sample("HDR", "suffix .pic", "bytes", ".pic", head + size + rle(codes), shown, tolerance)
    for order, stored in {
        "+Y {h} +X {w}": codes[::-1],
        "-Y {h} -X {w}": codes[:, ::-1],
        "+Y {h} -X {w}": codes[::-1, ::-1],
        "+X {w} -Y {h}": codes.transpose(1, 0, 2)[:, :],
        "-X {w} +Y {h}": codes.transpose(1, 0, 2)[::-1, ::-1],
    }.items():
        line = ("\n" + order.format(w=WIDTH, h=HEIGHT) + "\n").encode()
        yield Sample(
            "HDR",
            f"order {order.format(w='w', h='h')}",
            "bytes",
            ".hdr",
            head + line + rle(numpy.ascontiguousarray(stored)),
            shown,
            tolerance,
        )
    bright = rgbe(linear * 4)
    yield Sample(
        "HDR",
        "exposure 4",
        "bytes",
        ".hdr",
        head + b"EXPOSURE=4\n" + size + rle(bright),
        linear_to_srgb(numpy.minimum(unpacked(bright), 1)),
        tolerance,
    )
    yield Sample(
        "HDR",
        "gamma 2.2",
        "bytes",
        ".hdr",
        head + b"GAMMA=2.2\n" + size + rle(rgbe(scaled(picture(3)))),
        scaled(picture(3)),
        tolerance,
    )
    xyz = linear @ numpy.array([[0.4124, 0.2126, 0.0193], [0.3576, 0.7152, 0.1192], [0.1805, 0.0722, 0.9505]])
    yield Sample(
        "HDR",
        "XYZE",
        "bytes",
        ".hdr",
        head.replace(b"rgbe", b"xyze") + size + rle(rgbe(xyz)),
        linear_to_srgb(linear),
        4 / 255,
    )
    from_adobe = numpy.array([[1.39836, -0.39836, 0.0], [0.0, 1.0, 0.0], [0.0, -0.04293, 1.04293]])
    dull = rgbe(linear * 0.5 + 0.2)
    converted = linear_to_srgb(numpy.clip(unpacked(dull) @ from_adobe.T, 0, 1))
    line = b"PRIMARIES= 0.64 0.33 0.21 0.71 0.15 0.06 0.3127 0.329\n"
    yield Sample("HDR", "primaries of Adobe RGB", "bytes", ".hdr", head + line + size + rle(dull), converted, tolerance)
