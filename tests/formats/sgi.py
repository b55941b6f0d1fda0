"""SGI: one and two bytes a sample, one to five channels, packed and not."""

import struct

import numpy

from picture import HEIGHT, WIDTH, Sample, picture, scaled

REFUSED = r" 2 channels|, colormap"


def packed_row(row, size):
    """Runs and copies of values."""
    out, at, code = b"", 0, ">B" if size == 1 else ">H"
    while at < len(row):
        run = 1
        while at + run < len(row) and run < 127 and row[at + run] == row[at]:
            run += 1
        if run > 2:
            out += struct.pack(code, run) + struct.pack(code, row[at])
        else:
            run = min(9, len(row) - at)
            out += struct.pack(code, 128 | run) + b"".join(struct.pack(code, v) for v in row[at : at + run])
        at += run
    return out + struct.pack(code, 0)


def sgi(values, size, rle, dimension=None, colormap=0):
    channels = values.shape[2]
    dimension = dimension or (2 if channels == 1 else 3)
    peak = 255 if size == 1 else 65535
    head = struct.pack(
        ">hBBHHHHii4x80sI404x", 474, rle, size, dimension, WIDTH, HEIGHT, channels, 0, peak, b"by hand", colormap
    )
    planes = [values[::-1, :, c].tolist() for c in range(channels)]  # from the bottom upwards
    if not rle:
        return head + b"".join(numpy.array(plane).astype(f">u{size}").tobytes() for plane in planes)
    rows = [packed_row(row, size) for plane in planes for row in plane]
    starts, at = [], 512 + 8 * len(rows)
    for row in rows:
        starts.append(at)
        at += len(row)
    return (
        head + struct.pack(f">{len(rows)}I", *starts) + struct.pack(f">{len(rows)}I", *map(len, rows)) + b"".join(rows)
    )


def samples():
    for size, peak in ((1, 255), (2, 65535)):
        for channels in (1, 2, 3, 4):
            values = picture(channels, peak)
            for rle in (0, 1):
                name = f"{8 * size} bits, {channels} channels{', packed' if rle else ''}"
                yield Sample("SGI", name, "bytes", ".sgi", sgi(values, size, rle), scaled(values, peak))
        five = numpy.concatenate([picture(4, peak), picture(1, peak)], -1)
        yield Sample(
            "SGI", f"{8 * size} bits, 5 channels", "bytes", ".sgi", sgi(five, size, 0), scaled(picture(4, peak), peak)
        )
    three = picture(3)
    dithered = ((three[..., 0] >> 5) | (three[..., 1] >> 5) << 3 | (three[..., 2] >> 6) << 6)[..., None]
    shown = numpy.stack([(three[..., 0] >> 5) / 7, (three[..., 1] >> 5) / 7, (three[..., 2] >> 6) / 3], -1)
    yield Sample("SGI", "colormap 1 (dithered)", "bytes", ".sgi", sgi(dithered, 1, 0, colormap=1), shown)
    yield Sample("SGI", "colormap 2 (indices)", "bytes", ".sgi", sgi(dithered, 1, 0, colormap=2), None)
    yield Sample("SGI", "colormap 3 (a map)", "bytes", ".sgi", sgi(three, 1, 0, colormap=3), None)
