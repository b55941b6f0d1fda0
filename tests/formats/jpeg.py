"""JPEG by libjpeg-turbo (Pillow, OpenCV, imagecodecs): colours, subsampling, progressive and arithmetic, inks, orientation."""

import io

import numpy

from picture import Sample, picture, scaled

REFUSED = r", CMYK without|, lossless"


def samples():
    import imagecodecs
    from PIL import Image

    W, H = 48, 40
    for mode, channels in (("L", 1), ("RGB", 3)):
        pixels = picture(channels, 255, W, H)
        image = Image.fromarray(pixels.astype("u1").squeeze(), mode)
        for options in (
            {},
            {"progressive": True},
            {"optimize": True},
            {"restart_marker_blocks": 2},
            {"keep_rgb": True},
        ):
            for subsampling in (0, 1, 2) if channels == 3 else (0,):
                if "keep_rgb" in options and (subsampling or channels == 1):
                    continue
                out = io.BytesIO()
                image.save(out, "JPEG", quality=100, subsampling=subsampling, **options)
                yield Sample(
                    "JPEG",
                    f"{mode}, subsampling {subsampling}, {' '.join(options) or 'plain'}",
                    "Pillow",
                    ".jpg",
                    out.getvalue(),
                    scaled(pixels),
                    (3 if not subsampling else 9) / 255,
                )
        data = imagecodecs.jpeg8_encode(
            pixels.astype("u1").squeeze(), level=100, subsampling="440" if channels == 3 else None
        )
        yield Sample("JPEG", f"{mode}, 4:4:0", "imagecodecs", ".jpg", data, scaled(pixels), 9 / 255)
    rgb = picture(3, 255, W, H)
    image = Image.fromarray(rgb.astype("u1"))
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
        image.transpose(turn).save(out, "JPEG", quality=100, subsampling=0, exif=exif)
        yield Sample("JPEG", f"orientation {orientation}", "Pillow", ".jpg", out.getvalue(), scaled(rgb), 3 / 255)
    out = io.BytesIO()
    Image.fromarray(picture(4, 255, W, H).astype("u1"), "CMYK").save(out, "JPEG", quality=100)
    yield Sample("JPEG", "CMYK without a profile", "Pillow", ".jpg", out.getvalue(), None)
    data = (
        imagecodecs.jpeg12_encode(picture(1, 4095, W, H)[..., 0].astype("u2"), level=100)
        if hasattr(imagecodecs, "jpeg12_encode")
        else b""
    )
    if data:
        yield Sample("JPEG", "12 bits", "imagecodecs", ".jpg", data, scaled(picture(1, 4095, W, H), 4095), 2 / 255)
    data = imagecodecs.ljpeg_encode(picture(1, 255, W, H)[..., 0].astype("u1"))
    yield Sample("JPEG", "lossless", "imagecodecs", ".jpg", data, scaled(picture(1, 255, W, H)))
