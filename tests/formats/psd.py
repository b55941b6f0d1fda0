"""PSD: the merged picture in all modes, depths and packings, with alpha and without."""

import struct

import numpy

from picture import HEIGHT, WIDTH, Sample, indexed, picture, scaled

REFUSED = r"with transparency|, (indexed|duotone|CMYK|Lab|multichannel)|32 bits"

BITMAP, GREY, INDEXED, RGB, CMYK, MULTICHANNEL, DUOTONE, LAB = 0, 1, 2, 3, 4, 7, 8, 9


def packbits(data):
    out, at = b"", 0
    while at < len(data):
        run = 1
        while at + run < len(data) and run < 128 and data[at + run] == data[at]:
            run += 1
        if run > 1:
            out += bytes((257 - run, data[at]))
        else:
            run = min(7, len(data) - at)
            out += bytes((run - 1,)) + data[at : at + run]
        at += run
    return out


def rows_of(plane, bits):
    if bits == 1:
        return [numpy.packbits(row.astype(bool)).tobytes() for row in plane]
    return [row.astype({8: "u1", 16: ">u2", 32: ">f4"}[bits]).tobytes() for row in plane]


def resource(number, data):
    return b"8BIM" + struct.pack(">H", number) + b"\0\0" + struct.pack(">I", len(data)) + data + bytes(len(data) % 2)


def psd(mode, bits, planes, rle=False, colours=b"", layers=b"", resources=b"", version=1):
    rows = [row for plane in planes for row in rows_of(plane, bits)]
    if rle:
        packed = [packbits(row) for row in rows]
        data = (
            b"\0\1" + struct.pack(f">{len(packed)}{'H' if version == 1 else 'I'}", *map(len, packed)) + b"".join(packed)
        )
    else:
        data = b"\0\0" + b"".join(rows)
    size = ">I" if version == 1 else ">Q"
    return (
        b"8BPS"
        + struct.pack(">H6xHIIHH", version, len(planes), HEIGHT, WIDTH, bits, mode)
        + struct.pack(">I", len(colours))
        + colours
        + struct.pack(">I", len(resources))
        + resources
        + struct.pack(size, len(layers))
        + layers
        + data
    )


def merged_alpha():
    """A section of layers that says that the first alpha channel is the transparency of the merged picture: -1 layers."""
    info = (
        struct.pack(">h", -1)
        + struct.pack(">iiiiH", 0, 0, 0, 0, 0)
        + b"8BIMnorm\xff\0\0\0"
        + struct.pack(">I", 12)
        + bytes(8)
        + b"\1L\0\0"
    )
    info += bytes(len(info) % 2)
    return struct.pack(">I", len(info)) + info + struct.pack(">I", 0)


def on_white(straight):
    """Photoshop stores the colours of a merged picture with transparency blended with white."""
    return straight[..., :-1] * straight[..., -1:] + 1 - straight[..., -1:]


def planes_of(samples):
    return [samples[..., c] for c in range(samples.shape[2])]


def by_hand():
    for rle in (False, True):
        name = ", packed" if rle else ""
        for bits, peak in ((8, 255), (16, 65535)):
            for channels, mode, label in ((1, GREY, "grey"), (3, RGB, "RGB")):
                values = picture(channels, peak)
                yield f"{label}, {bits} bits{name}", psd(mode, bits, planes_of(values), rle), scaled(values, peak)
                mask = 1 - scaled(picture(1)[..., 0])
                yield (
                    f"{label} and a mask, {bits} bits{name}",
                    psd(mode, bits, planes_of(values) + [numpy.rint(mask * peak)], rle),
                    scaled(values, peak),
                )
                straight = scaled(picture(channels + 1, peak), peak)
                stored = numpy.rint(numpy.concatenate([on_white(straight), straight[..., -1:]], -1) * peak)
                yield f"{label} with transparency, {bits} bits{name}", psd(
                    mode, bits, planes_of(stored), rle, layers=merged_alpha()
                ), straight
        yield f"PSB, RGB, 8 bits{name}", psd(RGB, 8, planes_of(picture(3)), rle, version=2), scaled(picture(3))
        palette, indices = indexed(256)
        yield f"indexed{name}", psd(INDEXED, 8, [indices], rle, colours=palette.T.astype("u1").tobytes()), scaled(
            palette[indices]
        )
        ink = 1 - picture(1, 1)
        yield f"bitmap{name}", psd(BITMAP, 1, [ink[..., 0]], rle), scaled(1 - ink, 1)
        yield f"duotone{name}", psd(DUOTONE, 8, planes_of(picture(1)), rle, colours=bytes(600)), scaled(picture(1))
        yield f"CMYK{name}", psd(CMYK, 8, planes_of(picture(4)), rle), None
        yield f"Lab{name}", psd(LAB, 8, planes_of(picture(3)), rle), None
        yield f"multichannel{name}", psd(MULTICHANNEL, 8, planes_of(picture(3)), rle), None
    yield "RGB, 32 bits", psd(RGB, 32, planes_of(scaled(picture(3)))), None


def samples():
    for variant, data, expected in by_hand():
        yield Sample(
            "PSD", variant, "bytes", ".psd", data, expected, 2.5 / 255 if "transparency" in variant else 1 / 255
        )
