"""OpenEXR: by hand, and by the OpenEXR library: kinds of samples, packings, windows, tiles, channels, parts."""

import os
import struct
import tempfile

import numpy

from picture import HEIGHT, WIDTH, Sample, linear_to_srgb, picture, premultiplied, scaled

REFUSED = r"unsigned integers|of a layer only|for each colour|and chroma"

UINT, HALF, FLOAT = 0, 1, 2


def attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(value)) + value


def exr(planes, kind=FLOAT, data_window=None, display_window=None, sampling=None, order=0, more=b""):
    """Scan lines without packing.  `planes` maps names to arrays of the size of the data window."""
    names = sorted(planes)
    height, width = planes[max(names, key=lambda n: planes[n].size)].shape
    data_window = data_window or (0, 0, width - 1, height - 1)
    display_window = display_window or data_window
    sampling = sampling or {}
    table = (
        b"".join(
            name.encode() + b"\0" + struct.pack("<iB3xii", kind, 0, *(sampling.get(name, (1, 1)))) for name in names
        )
        + b"\0"
    )
    header = (
        struct.pack("<II", 20000630, 2)
        + attribute("channels", "chlist", table)
        + attribute("compression", "compression", b"\0")
    )
    header += attribute("dataWindow", "box2i", struct.pack("<4i", *data_window)) + attribute(
        "displayWindow", "box2i", struct.pack("<4i", *display_window)
    )
    header += attribute("lineOrder", "lineOrder", bytes((order,))) + attribute(
        "pixelAspectRatio", "float", struct.pack("<f", 1)
    )
    header += (
        attribute("screenWindowCenter", "v2f", bytes(8))
        + attribute("screenWindowWidth", "float", struct.pack("<f", 1))
        + more
        + b"\0"
    )
    dtype = {UINT: "<u4", HALF: "<f2", FLOAT: "<f4"}[kind]
    lines = []
    for y in range(height):
        row = b""
        for name in names:
            step = sampling.get(name, (1, 1))[1]
            if (y + data_window[1]) % step == 0:
                row += planes[name][y // step].astype(dtype).tobytes()
        lines.append(struct.pack("<iI", data_window[1] + y, len(row)) + row)
    at, offsets = len(header) + 8 * height, []
    for line in lines:
        offsets.append(at)
        at += len(line)
    if order == 1:  # the last line first
        at, offsets = len(header) + 8 * height, []
        for line in lines[::-1]:
            offsets.insert(0, at)
            at += len(line)
        lines = lines[::-1]
    return header + struct.pack(f"<{height}Q", *offsets) + b"".join(lines)


def to_linear(straight):
    v = numpy.array(straight)
    colours = slice(0, v.shape[2] - (v.shape[2] in (2, 4)))
    c = v[..., colours]
    v[..., colours] = numpy.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    return premultiplied(v)


def named(samples):
    names = {1: "Y", 2: "YA", 3: "RGB", 4: "RGBA"}[samples.shape[2]]
    return {name: samples[..., c] for c, name in enumerate(names)}


def by_hand():
    for channels in (1, 2, 3, 4):
        shown = scaled(picture(channels))
        planes = named(to_linear(shown))
        for kind, name in ((HALF, "half"), (FLOAT, "float")):
            yield f"{'/'.join(planes)}, {name}", exr(planes, kind), shown
    shown = scaled(picture(3))
    planes = named(to_linear(shown))
    yield "RGB, unsigned integers", exr({n: numpy.rint(p * 2**31) for n, p in planes.items()}, UINT), None
    yield "RGB, lines downwards first", exr(planes, order=1), shown
    yield "data window away from 0", exr(planes, data_window=(10, -7, 9 + WIDTH, HEIGHT - 8)), shown
    inner = {n: p[3:15, 5:30] for n, p in planes.items()}
    bigger = numpy.zeros_like(shown)
    bigger[3:15, 5:30] = shown[3:15, 5:30]
    yield "data window within the display window", exr(
        inner, data_window=(5, 3, 29, 14), display_window=(0, 0, WIDTH - 1, HEIGHT - 1)
    ), bigger
    yield "data window beyond the display window", exr(planes, display_window=(5, 3, 29, 14)), shown[3:15, 5:30]
    alpha = named(to_linear(scaled(picture(4))))
    inner = {n: p[3:15, 5:30] for n, p in alpha.items()}
    bigger = numpy.zeros((HEIGHT, WIDTH, 4))
    bigger[3:15, 5:30] = scaled(picture(4))[3:15, 5:30]
    yield "RGBA, data window within the display window", exr(
        inner, data_window=(5, 3, 29, 14), display_window=(0, 0, WIDTH - 1, HEIGHT - 1)
    ), bigger
    yield "RGB and depth", exr({**planes, "Z": planes["R"] + 3}), shown
    yield "RGBA and more", exr({**alpha, "Z": planes["R"] + 3, "id": planes["G"]}), scaled(picture(4))
    yield "layers and RGB", exr(
        {**planes, "diffuse.R": planes["G"], "diffuse.G": planes["B"], "diffuse.B": planes["R"]}
    ), shown
    yield "channels of a layer only", exr({f"left.{n}": p for n, p in planes.items()}), None
    yield "R alone", exr({"R": planes["R"]}), shown[..., :1]
    yield "alpha for each colour", exr({**planes, "AR": planes["R"], "AG": planes["R"], "AB": planes["R"]}), None
    chroma = b"".join(struct.pack("<f", v) for v in (0.64, 0.33, 0.21, 0.71, 0.15, 0.06, 0.3127, 0.329))
    from_adobe = numpy.array([[1.39836, -0.39836, 0.0], [0.0, 1.0, 0.0], [0.0, -0.04293, 1.04293]])
    linear = to_linear(shown) * 0.5 + 0.2
    yield (
        "primaries of Adobe RGB",
        exr(named(linear), more=attribute("chromaticities", "chromaticities", chroma)),
        linear_to_srgb(numpy.clip(linear @ from_adobe.T, 0, 1)),
    )
    full = to_linear(scaled(picture(3)))
    luma = full @ [0.2126, 0.7152, 0.0722]
    yc = {"Y": luma, "RY": ((full[..., 0] - luma) / luma)[::2, ::2], "BY": ((full[..., 2] - luma) / luma)[::2, ::2]}
    yield "luminance and chroma", exr(yc, HALF, sampling={"RY": (2, 2), "BY": (2, 2)}), None


def by_openexr():
    """Packings, tiles and parts, by the library of the format.  DWA and B44 lose a little."""
    import OpenEXR

    compressions = {
        name: getattr(OpenEXR, name + "_COMPRESSION")
        for name in ("NO", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB")
    }
    shown = scaled(picture(4))
    with tempfile.TemporaryDirectory() as folder:

        def write(header):
            name = os.path.join(folder, "a.exr")
            OpenEXR.File(header, {"RGBA": to_linear(shown).astype("f2")}).write(name)
            with open(name, "rb") as file:
                return file.read()

        for name, compression in compressions.items():
            loss = 6 / 255 if name[0] in "BD" else 1 / 255
            yield f"{name}", write({"compression": compression, "type": OpenEXR.scanlineimage}), shown, loss
            tiles = {"compression": compression, "type": OpenEXR.tiledimage, "tiles": OpenEXR.TileDescription()}
            yield f"{name}, tiles", write(tiles), shown, loss
        other = {"RGBA": 1 - to_linear(shown).astype("f2")}
        name = os.path.join(folder, "parts.exr")
        parts = [
            OpenEXR.Part({"type": OpenEXR.scanlineimage}, c, n)
            for c, n in (({"RGBA": to_linear(shown).astype("f2")}, "first"), (other, "second"))
        ]
        OpenEXR.File(parts).write(name)
        with open(name, "rb") as file:
            yield "two parts", file.read(), shown, 1 / 255


def samples():
    for variant, data, expected, tolerance in by_openexr():
        yield Sample("OpenEXR", variant, "OpenEXR", ".exr", data, expected, tolerance)
    for variant, data, expected in by_hand():
        yield Sample("OpenEXR", variant, "bytes", ".exr", data, expected)
