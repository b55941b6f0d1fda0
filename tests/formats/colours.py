"""What files say of their colours, and of how their pixels lie: PNG, JPEG, TIFF, WebP and AVIF that say it in each of their
ways, and in several at once."""

import io
import pathlib
import struct
import sys
import zlib

import numpy
from picture import Sample, linear_to_srgb, picture, scaled
from png import GREY, RGB, RGBA, chunk, png

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
import images  # noqa: E402
import profiles  # noqa: E402

REFUSED = r"PQ|HLG|inks without a profile"

FULL = scaled(picture(3)) * 0.6 + 0.25  # within the gamut of sRGB whatever the primaries
PIXELS = numpy.rint(FULL * 255).astype(int)
WIDE = (profiles.DISPLAY_P3, profiles.BT2020, profiles.ADOBE_RGB)


def converted(samples, primaries=profiles.SRGB, gamma=None):
    """Samples of these primaries and gamma (default: the curve of sRGB) in sRGB."""
    flat = samples.reshape(-1, samples.shape[2])
    if samples.shape[2] in (1, 2):
        light = flat[:, :1] ** gamma if gamma else profiles_light(flat[:, :1])
        colours = linear_to_srgb(light)
    else:
        matrix = numpy.linalg.solve(
            numpy.array(profiles.to_d50(profiles.SRGB)), numpy.array(profiles.to_d50(primaries))
        )
        light = flat[:, :3] ** gamma if gamma else profiles_light(flat[:, :3])
        colours = linear_to_srgb((light @ matrix.T).clip(0, 1))
    out = samples.copy()
    out[..., : colours.shape[1]] = colours.reshape(samples.shape[:2] + (-1,))
    return out


def profiles_light(v):
    return numpy.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)


def gama(value):
    return b"gAMA", struct.pack(">I", value)


def chrm(primaries):
    return b"cHRM", struct.pack(">8I", *(round(100000 * v) for xy in primaries for v in xy))


def cicp(primaries, transfer):
    return b"cICP", bytes((primaries, transfer, 0, 1))


def iccp(profile):
    return b"iCCP", b"a profile\0\0" + zlib.compress(profile)


def raw_text(name, data, packed=True):
    text = (
        f"\n{name}\n{len(data):8}\n".encode()
        + b"\n".join(data.hex()[i : i + 72].encode() for i in range(0, 2 * len(data), 72))
        + b"\n"
    )
    keyword = f"Raw profile type {name}\0".encode()
    return (b"zTXt", keyword + b"\0" + zlib.compress(text)) if packed else (b"tEXt", keyword + text)


def xmp_turned(orientation):
    return b'<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:Description tiff:Orientation="%d"/></x:xmpmeta>' % orientation


def png_colours():
    full = scaled(PIXELS)
    p3 = profiles.icc_rgb(profiles.DISPLAY_P3)
    adobe_exif = profiles.exif_bytes([(0x8769, [(0xA001, 65535), (0xA005, [(1, "R03")])])])
    for name, chunks, shown in (
        ("nothing", [], full),
        ("gAMA 1", [gama(100000)], converted(full, gamma=1.0)),
        ("gAMA 1/1.8", [gama(55556)], converted(full, gamma=1.8)),
        ("gAMA of sRGB", [gama(45455)], full),
        ("cHRM of P3", [chrm(profiles.DISPLAY_P3)], converted(full, profiles.DISPLAY_P3)),
        (
            "cHRM and gAMA of Adobe RGB",
            [gama(45470), chrm(profiles.ADOBE_RGB)],
            converted(full, profiles.ADOBE_RGB, 2.19922),
        ),
        ("sRGB before gAMA and cHRM", [(b"sRGB", b"\0"), gama(100000), chrm(profiles.BT2020)], full),
        ("profile", [iccp(p3)], converted(full, profiles.DISPLAY_P3)),
        ("profile before gAMA", [iccp(p3), gama(100000)], converted(full, profiles.DISPLAY_P3)),
        ("profile of gamma 1.8", [iccp(profiles.icc_rgb(profiles.SRGB, 1.8))], converted(full, gamma=1.8)),
        ("profile of sRGB", [iccp(profiles.icc_rgb(profiles.SRGB))], full),
        ("code points of P3", [cicp(12, 13)], converted(full, profiles.DISPLAY_P3)),
        ("code points of linear sRGB", [cicp(1, 8)], converted(full, gamma=1.0)),
        ("code points of sRGB before profile", [cicp(1, 13), iccp(p3)], full),
        ("code points of BT.2020", [cicp(9, 14)], converted(full, profiles.BT2020)),
        ("code points, gamma 2.2", [cicp(1, 4)], converted(full, gamma=2.2)),
        ("PQ", [cicp(9, 16)], None),
        ("HLG", [cicp(9, 18)], None),
        ("Adobe RGB by EXIF", [(b"eXIf", adobe_exif)], converted(full, profiles.ADOBE_RGB, 563 / 256)),
        ("profile before EXIF", [iccp(p3), (b"eXIf", adobe_exif)], converted(full, profiles.DISPLAY_P3)),
    ):
        yield f"RGB, {name}", ".png", png(PIXELS, RGB, 8, chunks), shown
    for depth in (8, 16):
        peak = 2**depth - 1
        grey, grey_alpha = picture(1, peak), picture(2, peak)
        for name, chunks, gamma in (
            ("gAMA 1", [gama(100000)], 1.0),
            ("profile", [iccp(profiles.icc_grey(1.8))], 1.8),
            ("profile of RGB", [iccp(profiles.icc_rgb(profiles.DISPLAY_P3, 1.8))], 1.8),
        ):
            yield f"grey, {depth} bits, {name}", ".png", png(grey, GREY, depth, chunks), converted(
                scaled(grey, peak), gamma=gamma
            )
            data = png(grey_alpha, 4, depth, chunks)
            yield f"grey and alpha, {depth} bits, {name}", ".png", data, converted(
                scaled(grey_alpha, peak), gamma=gamma
            )
    rgba = picture(4)
    rgba[..., :3] = PIXELS
    yield "RGBA, profile", ".png", png(rgba, RGBA, 8, [iccp(p3)]), converted(scaled(rgba), profiles.DISPLAY_P3)
    yield "RGBA, gAMA 1", ".png", png(rgba, RGBA, 8, [gama(100000)]), converted(scaled(rgba), gamma=1.0)


def turned(orientation):
    """The pixels as they are stored for an orientation."""
    from PIL import Image

    T = Image.Transpose
    turn = {
        1: None,
        2: T.FLIP_LEFT_RIGHT,
        3: T.ROTATE_180,
        4: T.FLIP_TOP_BOTTOM,
        5: T.TRANSPOSE,
        6: T.ROTATE_90,
        7: T.TRANSVERSE,
        8: T.ROTATE_270,
    }[orientation]
    image = Image.fromarray(PIXELS.astype("u1"))
    return image if turn is None else image.transpose(turn)


def png_orientations():
    full = scaled(PIXELS)
    for orientation in (3, 6):
        stored = numpy.asarray(turned(orientation)).astype(int)
        exif = profiles.exif_bytes([(profiles.ORIENTATION, orientation)])
        app1 = b"Exif\0\0" + exif
        for name, chunks in (
            ("eXIf", [(b"eXIf", exif)]),
            ("raw profile exif", [raw_text("exif", app1)]),
            ("raw profile exif, not packed", [raw_text("exif", app1, False)]),
            ("raw profile APP1", [raw_text("APP1", app1)]),
            ("raw profile without prefix", [raw_text("exif", exif)]),
            (
                "eXIf before raw profile",
                [raw_text("exif", profiles.exif_bytes([(profiles.ORIENTATION, 8)])), (b"eXIf", exif)],
            ),
        ):
            yield f"orientation {orientation}, {name}", ".png", png(stored, RGB, 8, chunks), full
        xmp = b"iTXt", b"XML:com.adobe.xmp\0\0\0\0\0" + xmp_turned(orientation)
        yield f"orientation {orientation}, XMP, which does not count", ".png", png(PIXELS, RGB, 8, [xmp]), full


def jpegs():
    full = scaled(PIXELS)
    adobe = profiles.exif_bytes([(0x8769, [(0xA001, 65535), (0xA005, [(1, "R03")])])])
    uncalibrated = profiles.exif_bytes([(0x8769, [(0xA001, 65535)])])
    adobe_by_number = profiles.exif_bytes([(0x8769, [(0xA001, 2)])])
    p3 = profiles.icc_rgb(profiles.DISPLAY_P3)
    for name, options, shown in (
        ("nothing", {}, full),
        ("profile", {"icc_profile": p3}, converted(full, profiles.DISPLAY_P3)),
        ("Adobe RGB by EXIF", {"exif": b"Exif\0\0" + adobe}, converted(full, profiles.ADOBE_RGB, 563 / 256)),
        (
            "Adobe RGB by a number of EXIF",
            {"exif": b"Exif\0\0" + adobe_by_number},
            converted(full, profiles.ADOBE_RGB, 563 / 256),
        ),
        ("uncalibrated by EXIF", {"exif": b"Exif\0\0" + uncalibrated}, full),
        ("profile before EXIF", {"exif": b"Exif\0\0" + adobe, "icc_profile": p3}, converted(full, profiles.DISPLAY_P3)),
    ):
        out = io.BytesIO()
        turned(1).save(out, "JPEG", quality=100, subsampling=0, **options)
        yield f"JPEG, {name}", ".jpg", out.getvalue(), shown
    for orientation in (2, 5, 8):
        exif = b"Exif\0\0" + profiles.exif_bytes([(profiles.ORIENTATION, orientation)])
        out = io.BytesIO()
        turned(orientation).save(out, "JPEG", quality=100, subsampling=0, exif=exif)
        yield f"JPEG, orientation {orientation}", ".jpg", out.getvalue(), full
        out = io.BytesIO()
        turned(1).save(out, "JPEG", quality=100, subsampling=0, xmp=xmp_turned(orientation))
        yield f"JPEG, orientation {orientation} by XMP, which does not count", ".jpg", out.getvalue(), full
    inks = images.Image(16, 8, 4, 8, [200, 100, 50, 10] * 128)
    yield "JPEG, inks without a profile", ".jpg", images.jpeg_bytes(inks), None


def others():
    full = scaled(PIXELS)
    p3 = profiles.icc_rgb(profiles.DISPLAY_P3)
    image = turned(1)
    for kind, suffix, options in (("TIFF", ".tif", {}), ("WEBP", ".webp", {"lossless": True})):
        out = io.BytesIO()
        image.save(out, kind, icc_profile=p3, **options)
        yield f"{kind}, profile", suffix, out.getvalue(), converted(full, profiles.DISPLAY_P3)
    for orientation in (4, 7):
        out = io.BytesIO()
        turned(orientation).save(out, "TIFF", tiffinfo={274: orientation})
        yield f"TIFF, orientation {orientation}", ".tif", out.getvalue(), full
        out = io.BytesIO()
        image.save(out, "TIFF", tiffinfo={700: xmp_turned(orientation)})
        yield f"TIFF, orientation {orientation} by XMP, which does not count", ".tif", out.getvalue(), full
        exif = b"Exif\0\0" + profiles.exif_bytes([(profiles.ORIENTATION, orientation)])
        out = io.BytesIO()
        turned(orientation).save(out, "WEBP", lossless=True, exif=exif)
        yield f"WEBP, orientation {orientation}", ".webp", out.getvalue(), full
    width, height, colour = images.AVIF_IMAGE
    flat = numpy.ones((height, width, 3)) * numpy.array(colour) / 255
    for name, points, profile, shown in (
        ("code points of P3", (12, 13), None, converted(flat, profiles.DISPLAY_P3)),
        ("code points of sRGB", (1, 13), None, flat),
        ("profile before code points", (12, 13), profiles.icc_rgb(profiles.SRGB, 1.8), converted(flat, gamma=1.8)),
        ("PQ", (9, 16), None, None),
    ):
        yield f"AVIF, {name}", ".avif", images.avif_bytes(points, profile), shown


def samples():
    for part in (png_colours, png_orientations, jpegs, others):
        for variant, suffix, data, expected in part():
            tolerance = 12 if "JPEG" in variant else 2.6
            yield Sample("colours", variant, "bytes", suffix, data, expected, tolerance / 255)
