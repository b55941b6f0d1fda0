"""HEIF: AVIF and HEIC by libavif, libheif (imagecodecs, Pillow): depths, alpha, turns, mirrors, ranges, subsampling."""

import io

import numpy

from picture import Sample, picture, scaled

W, H = 40, 24


def by_imagecodecs():
    import imagecodecs

    for bits in (8, 10, 12):
        peak = 2**bits - 1
        for channels in (1, 2, 3, 4):
            pixels = picture(channels, peak, W, H)
            stored = pixels.astype("u1" if bits == 8 else "u2")
            try:
                data = imagecodecs.avif_encode(
                    stored[..., 0] if channels == 1 else stored,
                    level=100,
                    bitspersample=bits,
                    speed=8,
                    pixelformat="444" if channels > 2 else None,
                )
            except Exception:
                continue
            yield f"AVIF, {bits} bits, {channels} channels", "libavif (imagecodecs)", ".avif", data, scaled(
                pixels, peak
            )


def by_pillow():
    from PIL import Image

    turned = {}
    for mode, channels in (("L", 1), ("RGB", 3), ("RGBA", 4)):
        pixels = picture(channels, 255, W, H)
        image = Image.fromarray(pixels.astype("u1").squeeze(), mode)
        for subsampling in ("4:4:4", "4:2:0"):
            for limited in ("full", "limited"):
                out = io.BytesIO()
                image.save(out, "AVIF", quality=100, subsampling=subsampling, range=limited, speed=8)
                yield f"AVIF, {mode}, {subsampling}, {limited} range", "Pillow", ".avif", out.getvalue(), scaled(pixels)
        if channels == 4:
            out = io.BytesIO()
            image.save(out, "AVIF", quality=100, alpha_premultiplied=True, subsampling="4:4:4", speed=8)
            yield "AVIF, premultiplied", "Pillow", ".avif", out.getvalue(), scaled(pixels)
    pixels = picture(3, 255, W, H)
    image = Image.fromarray(pixels.astype("u1"))
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
        exif = Image.Exif()
        exif[0x0112] = orientation
        out = io.BytesIO()
        image.transpose(turn).save(out, "AVIF", quality=100, subsampling="4:4:4", exif=exif, speed=8)
        yield f"AVIF, orientation {orientation}", "Pillow", ".avif", out.getvalue(), scaled(pixels)


def by_libheif():
    import pillow_heif
    from PIL import Image

    for mode, channels in (("L", 1), ("RGB", 3), ("RGBA", 4)):
        pixels = picture(channels, 255, W, H)
        for chroma in (444, 420):
            out = io.BytesIO()
            heif = pillow_heif.from_pillow(Image.fromarray(pixels.astype("u1").squeeze(), mode))
            heif.save(out, quality=-1, chroma=chroma, format="HEIF")
            yield f"HEIC, {mode}, {chroma}", "libheif (pillow-heif)", ".heic", out.getvalue(), scaled(pixels)
    pixels = picture(3, 65535, W, H)
    out = io.BytesIO()
    pillow_heif.encode("RGB;16", (W, H), pixels.astype("<u2").tobytes(), out, quality=-1, chroma=444, format="HEIF")
    yield "HEIC, RGB of 10 or 12 bits", "libheif (pillow-heif)", ".heic", out.getvalue(), scaled(pixels, 65535)


def samples():
    for part in (by_imagecodecs, by_pillow, by_libheif):
        for variant, writer, suffix, data, expected in part():
            loss = 8 if "4:2:0" in variant or "420" in variant else 3.2
            yield Sample("HEIF", variant, writer, suffix, data, expected, loss / 255)
