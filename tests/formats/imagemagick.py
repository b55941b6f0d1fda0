"""Files of many formats by ImageMagick."""

import subprocess

import numpy

from picture import HEIGHT, WIDTH, Sample, linear_to_srgb, picture, scaled

REFUSED = r"type palette|, psd, RGBA|, hdr,|^(dpx|cin|fits|miff|pcx|sun|pam|pict|viff|xwd|palm),"

KINDS = {1: "gray", 3: "rgb", 4: "rgba"}
NAMES = {1: "grey", 3: "RGB", 4: "RGBA"}


def written(coder, channels, *options):
    """The bytes of picture(channels); empty if this ImageMagick lacks the coder."""
    pixels = picture(channels, 255).astype("u1") * numpy.uint16(257)
    command = [
        "convert",
        "-size",
        f"{WIDTH}x{HEIGHT}",
        "-depth",
        "16",
        "-endian",
        "LSB",
        f"{KINDS[channels]}:-",
        *options,
        f"{coder}:-",
    ]
    done = subprocess.run(command, input=pixels.astype("<u2").tobytes(), capture_output=True, check=False)
    return done.stdout if done.returncode == 0 else b""


def as_written(coder, samples, options):
    """What ImageMagick 6 wrote of samples, as all other readers see it."""
    if coder == "tga":  # the rows lie from the top, the header says from the bottom
        return samples[::-1]
    if any("min-is-white" in option for option in options):  # the header says so, the samples stay
        return 1 - samples
    return samples


# Format, coder, suffix, channels, options, tolerance of 255.
FILES = [
    ("BMP", "bmp", ".bmp", (1, 3, 4), ((), ("-compress", "none")), 1),
    ("BMP", "bmp3", ".bmp", (1, 3), ((),), 1),
    ("BMP", "bmp3", ".bmp", (1, 3), (("-type", "palette"),), None),
    ("BMP", "bmp2", ".bmp", (1, 3), ((),), 1),
    ("TGA", "tga", ".tga", (1, 3, 4), ((), ("-compress", "rle")), 1),
    (
        "TIFF",
        "tiff",
        ".tif",
        (1, 3, 4),
        (
            ("-depth", "8"),
            ("-depth", "16"),
            ("-depth", "12"),
            ("-depth", "32"),
            ("-compress", "lzw"),
            ("-compress", "zip"),
            ("-compress", "zstd"),
            ("-compress", "rle"),
            ("-interlace", "plane"),
            ("-define", "tiff:tile-geometry=16x16"),
            ("-define", "tiff:rows-per-strip=5"),
            ("-endian", "MSB"),
            ("-define", "quantum:format=floating-point", "-depth", "32"),
            ("-define", "tiff:fill-order=lsb"),
        ),
        1,
    ),
    (
        "TIFF",
        "tiff",
        ".tif",
        (1,),
        (
            ("-define", "quantum:polarity=min-is-white"),
            ("-define", "quantum:polarity=min-is-white", "-depth", "8"),
            ("-define", "quantum:polarity=min-is-white", "-depth", "8", "-compress", "lzw"),
        ),
        1,
    ),
    ("TIFF", "tiff", ".tif", (4,), (("-define", "tiff:alpha=associated"), ("-define", "tiff:alpha=unassociated")), 1),
    (
        "TIFF",
        "tiff",
        ".tif",
        (1, 3),
        (("-compress", "jpeg", "-quality", "100"), ("-compress", "webp", "-define", "webp:lossless=true")),
        4,
    ),
    ("TIFF", "tiff64", ".tif", (1, 3, 4), (("-depth", "8"), ("-depth", "16"), ("-compress", "lzw")), 1),
    ("PNM", "pbm", ".pbm", (), ((),), 1),
    ("PNM", "pgm", ".pgm", (1,), (("-depth", "8"), ("-depth", "16"), ("-compress", "none")), 1),
    ("PNM", "ppm", ".ppm", (3,), (("-depth", "8"), ("-depth", "16"), ("-compress", "none")), 1),
    ("PNM", "pfm", ".pfm", (1, 3), ((), ("-endian", "MSB"), ("-endian", "LSB")), 1),
    (
        "SGI",
        "sgi",
        ".sgi",
        (1, 3, 4),
        (("-depth", "8"), ("-depth", "16"), ("-depth", "8", "-compress", "rle"), ("-depth", "8", "-compress", "none")),
        1,
    ),
    ("DDS", "dds", ".dds", (3, 4), (("-define", "dds:compression=none"),), 1),
    ("DDS", "dds", ".dds", (3,), (("-define", "dds:compression=dxt5"), ("-define", "dds:compression=dxt1")), None),
    ("ICO", "ico", ".ico", (1, 3, 4), ((), ("-compress", "none")), 1),
    ("GIF", "gif", ".gif", (1,), ((), ("-interlace", "gif")), 7),
    (
        "PSD",
        "psd",
        ".psd",
        (1, 3, 4),
        (("-depth", "8"), ("-depth", "16"), ("-depth", "8", "-compress", "none"), ("-depth", "8", "-compress", "rle")),
        1,
    ),
    ("HDR", "hdr", ".hdr", (3,), ((),), 3),
    ("JPEG 2000", "jp2", ".jp2", (1, 3, 4), (("-quality", "100"), ("-depth", "16", "-quality", "100")), 2),
    ("JPEG 2000", "j2k", ".j2k", (1, 3, 4), (("-quality", "100"),), 2),
    ("PNG", "png", ".png", (1, 3, 4), (("-depth", "8"), ("-depth", "16"), ("-interlace", "png")), 1),
    ("PNG", "png", ".png", (3,), (("-define", "png:color-type=3", "-colors", "256"),), None),
    (
        "JPEG",
        "jpeg",
        ".jpg",
        (1, 3),
        (("-quality", "100", "-sampling-factor", "4:4:4"), ("-quality", "100", "-interlace", "jpeg")),
        9,
    ),
    ("WebP", "webp", ".webp", (3, 4), (("-define", "webp:lossless=true"), ("-quality", "100")), 12),
    ("HEIF", "heic", ".heic", (1, 3), (("-quality", "100"),), 13),
    ("HEIF", "avif", ".avif", (1, 3), (("-quality", "100"),), 13),
]


def samples():
    for kind, coder, suffix, all_channels, all_options, tolerance in FILES:
        for channels in all_channels:
            for options in all_options:
                data = written(coder, channels, *options)
                if not data:
                    continue
                expected = as_written(coder, scaled(picture(channels)), options)
                variant = f"{coder}, {NAMES[channels]} {' '.join(options)}".strip()
                yield Sample(
                    kind,
                    variant,
                    "ImageMagick",
                    suffix,
                    data,
                    expected,
                    30 / 255 if tolerance is None else tolerance / 255,
                )
    for options in (
        (),
        ("-compress", "group4"),
        ("-compress", "fax"),
        ("-compress", "group4", "-define", "quantum:polarity=min-is-black"),
        ("-compress", "lzw"),
    ):
        data = written("tiff", 1, "-threshold", "50.3%", "-type", "bilevel", *options)
        if data:
            yield Sample(
                "TIFF", f"bilevel {' '.join(options)}".strip(), "ImageMagick", ".tif", data, (picture(1) > 128) * 1.0
            )
    for coder in ("dpx", "cin", "fits", "miff", "pcx", "sun", "pam", "pict", "viff", "xwd", "palm"):
        data = written(coder, 3)
        if data:
            yield Sample(coder, "RGB", "ImageMagick", "." + coder, data, None)
