"""What `gscl decode` writes in each format shows the same as the PNG that it writes, to two independent readers.

GSCL is the program."""

import os
import struct
import subprocess
import zlib

import numpy
import pytest
import readers
from picture import HEIGHT, WIDTH, difference, picture

GSCL = os.environ["GSCL"]
SUFFIXES = ("png", "jpg", "tif", "exr", "pgm", "ppm", "pnm", "bmp", "tga")
KINDS = [(channels, depth) for channels in (1, 2, 3, 4) for depth in (8, 16)]


def exr_by_hand(path):
    """Scan lines packed by ZIP or not, as the pages of OpenEXR describe them."""
    data = open(path, "rb").read()
    at, header = 8, {}
    while data[at]:
        name, kind, rest = data[at:].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        size = int.from_bytes(data[at : at + 4], "little")
        header[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    names, kinds, table = [], [], header[b"channels"]
    while table[0]:
        name, table = table.split(b"\0", 1)
        names.append(name.decode())
        kinds.append({1: "<f2", 2: "<f4"}[table[0]])
        table = table[16:]
    lines_of_block = {0: 1, 2: 1, 3: 16}[header[b"compression"][0]]
    x0, y0, x1, y1 = struct.unpack("<4i", header[b"dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    planes = {name: numpy.zeros((height, width)) for name in names}
    blocks = -(-height // lines_of_block)
    for offset in struct.unpack_from(f"<{blocks}Q", data, at + 1):
        y, size = struct.unpack_from("<ii", data, offset)
        lines = min(lines_of_block, y1 - y + 1)
        packed = data[offset + 8 : offset + 8 + size]
        if size < lines * width * sum(int(kind[2]) for kind in kinds):
            packed = unpredicted(zlib.decompress(packed))
        for line in range(lines):
            for name, kind in zip(names, kinds):
                values = numpy.frombuffer(packed, kind, width)
                planes[name][y - y0 + line] = values
                packed = packed[values.nbytes :]
    return readers.from_exr_planes(planes)


def unpredicted(data):
    """Sums the differences of bytes, and puts those of even places, which come first, between those of odd ones."""
    values = numpy.frombuffer(data, "u1").astype(int)
    values[1:] -= 128
    summed = (numpy.cumsum(values) % 256).astype("u1")
    half = (len(summed) + 1) // 2
    out = numpy.empty_like(summed)
    out[0::2], out[1::2] = summed[:half], summed[half:]
    return out.tobytes()


READERS = {
    "png": (readers.opencv, readers.magick),
    "jpg": (readers.pillow, readers.opencv),
    "tif": (readers.tifffile, readers.magick),
    "exr": (readers.openexr, exr_by_hand),
    "pgm": (readers.pillow, readers.opencv),
    "ppm": (readers.opencv, readers.magick),
    "pnm": (readers.opencv, readers.magick),
    "bmp": (readers.pillow, readers.opencv),
    "tga": (readers.pillow, readers.magick),
}


@pytest.fixture(scope="session")
def files(tmp_path_factory):
    """gscl files of all kinds of pixels."""
    import cv2

    folder = tmp_path_factory.mktemp("coded")
    made = {}
    for channels, depth in KINDS:
        pixels = picture(channels, 2**depth - 1).astype(f"u{depth // 8}")
        name = folder / f"{channels}_{depth}"
        if channels == 2:  # which OpenCV writes as RGBA
            import imagecodecs

            name.with_suffix(".png").write_bytes(imagecodecs.png_encode(pixels))
        else:
            cv2.imwrite(str(name.with_suffix(".png")), pixels[..., [2, 1, 0, 3][:channels]] if channels > 2 else pixels)
        subprocess.run(
            [
                GSCL,
                "encode",
                name.with_suffix(".png"),
                "-o",
                name.with_suffix(".gscl"),
                "--quiet",
                "--effort",
                "0",
                "--bpp",
                "4",
            ],
            check=True,
        )
        subprocess.run([GSCL, "decode", name.with_suffix(".gscl"), "-o", name.with_suffix(".out.png")], check=True)
        made[channels, depth] = name
    return made


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: f"{kind[0]} channels, {kind[1]} bits")
def test_two_readers_see_the_same(files, kind, suffix, tmp_path):
    name = files[kind]
    path = str(tmp_path / f"out.{suffix}")
    done = subprocess.run(
        [GSCL, "decode", name.with_suffix(".gscl"), "-o", path], capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        assert not os.path.exists(path)
        assert "cannot hold" in done.stderr
        return
    expected = readers.magick(str(name.with_suffix(".out.png")))
    for reader in READERS[suffix]:
        samples = reader(path)
        assert samples.shape[:2] == (HEIGHT, WIDTH)
        assert difference(samples, expected) <= (12 if suffix == "jpg" else 1.01) / 255, reader.__name__
