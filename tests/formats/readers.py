"""Readers of image files: gscl's, and independent ones."""

import io
import subprocess

import numpy
from picture import linear_to_srgb, straight


def gscl(program, paths):
    """Reads files with one process of read_images.  Yields (samples, None) or (None, message)."""
    done = subprocess.run(
        [program], input="".join(f"{path}\n" for path in paths).encode(), capture_output=True, check=False
    )
    out = io.BytesIO(done.stdout)
    for path in paths:
        line = out.readline().decode()
        if not line:
            raise SystemExit(f"read_images ended at {path} with {done.returncode}: {done.stderr.decode()[-500:]}")
        if line.startswith("error"):
            yield None, line[6:].strip()
            continue
        width, height, channels, kind, is_premultiplied = line.split()
        shape = int(height), int(width), int(channels)
        dtype = numpy.dtype(kind)
        samples = numpy.frombuffer(out.read(int(numpy.prod(shape)) * dtype.itemsize), dtype).reshape(shape)
        samples = (
            samples.astype(float).clip(0, 1) if kind == "f4" else samples / numpy.iinfo(dtype).max
        )  # as the encoder does
        yield (straight(samples) if is_premultiplied == "1" else samples), None


def pillow(path):
    from PIL import Image

    with Image.open(path) as image:
        if image.mode in ("P", "PA") or "transparency" in image.info:
            image = image.convert("RGBA" if "transparency" in image.info or image.mode == "PA" else "RGB")
        if image.mode == "1":
            image = image.convert("L")
        if image.mode in ("RGBa", "La"):
            image = image.convert(image.mode.upper())
        samples = numpy.asarray(image)
        if image.mode in ("CMYK", "LAB", "YCbCr", "HSV"):
            return None
        if image.mode == "I" or samples.dtype.kind == "i":
            samples = samples.astype(float) / 65535
        elif samples.dtype.kind == "u":
            samples = samples / numpy.iinfo(samples.dtype).max
    return shaped(samples)


def shaped(samples):
    samples = numpy.asarray(samples, float)
    return samples[..., None] if samples.ndim == 2 else samples


def magick(path):
    info = subprocess.run(
        ["identify", "-format", "%w %h %[channels] %A\n", path + "[0]"], capture_output=True, text=True, check=False
    )
    if info.returncode or not info.stdout:
        return None
    width, height, *rest = info.stdout.splitlines()[0].split()
    done = subprocess.run(
        ["convert", path + "[0]", "-auto-orient", "-colorspace", "sRGB", "-depth", "16", "-endian", "LSB", "rgba:-"],
        capture_output=True,
        check=False,
    )
    if done.returncode or len(done.stdout) != int(width) * int(height) * 8:
        return None
    return numpy.frombuffer(done.stdout, "<u2").reshape(int(height), int(width), 4) / 65535


def opencv(path):
    import cv2

    image = cv2.imread(path, cv2.IMREAD_UNCHANGED)
    if image is None:
        return None
    samples = image / (numpy.iinfo(image.dtype).max if image.dtype.kind == "u" else 1)
    samples = shaped(samples)
    if samples.shape[2] >= 3:
        samples = samples[..., [2, 1, 0, 3][: samples.shape[2]]]
    return samples


def tifffile(path):
    import tifffile as library

    if not path.endswith(".tif"):
        return None
    with library.TiffFile(path) as file:
        page = file.pages[0]
        if page.photometric.name not in ("MINISBLACK", "MINISWHITE", "RGB"):
            return None
        samples = page.asarray()
        samples = samples.transpose(1, 2, 0) if page.planarconfig == 2 and samples.ndim == 3 else samples
        samples = shaped(samples / (2**page.bitspersample - 1) if samples.dtype.kind in "bu" else samples)
        if page.photometric.name == "MINISWHITE":
            samples[..., :1] = 1 - samples[..., :1]
        return straight(samples) if list(page.extrasamples) == [1] else samples


def imagecodecs(path):
    """JPEG 2000 by OpenJPEG, AVIF by libavif, HEIC by libheif."""
    import imagecodecs as library

    decode = {".jp2": "jpeg2k_decode", ".j2k": "jpeg2k_decode", ".avif": "avif_decode", ".heic": "heif_decode"}
    suffix = path[path.rindex(".") :]
    if suffix not in decode:
        return None
    with open(path, "rb") as file:
        samples = getattr(library, decode[suffix])(file.read())
    if samples.dtype.kind == "i":
        samples = samples.astype(float) - numpy.iinfo(samples.dtype).min
        return shaped(samples / samples.max())
    # Of 10 and 12 bits in 16: the largest sample of the sweep's pictures is 0.95.
    peak = next(2**bits - 1 for bits in (8, 10, 12, 16) if samples.max() < 2**bits)
    return shaped(samples / peak)


def from_exr_planes(planes):
    """Linear light multiplied by alpha as straight samples on the curve of sRGB."""
    colours = ["Y"] if "Y" in planes else ["R", "G", "B"]
    samples = numpy.stack([planes[name] for name in colours + ["A"] * ("A" in planes)], -1)
    samples = straight(samples) if "A" in planes else samples
    samples[..., : len(colours)] = linear_to_srgb(samples[..., : len(colours)])
    return samples


def openexr(path):
    import OpenEXR

    if not path.endswith(".exr"):
        return None
    channels = OpenEXR.File(path, separate_channels=True).channels()
    return from_exr_planes({name: numpy.asarray(channel.pixels, float) for name, channel in channels.items()})
