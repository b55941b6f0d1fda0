"""WebP by libwebp (Pillow, OpenCV, imagecodecs): lossless and lossy, alpha, animations."""

import io

import numpy

from picture import Sample, picture, scaled

REFUSED = r"first frame a window"


def samples():
    import imagecodecs
    from PIL import Image

    for channels, mode in ((3, "RGB"), (4, "RGBA")):
        pixels = picture(channels).astype("u1")
        image = Image.fromarray(pixels, mode)
        for options, name, tolerance in (
            ({"lossless": True, "exact": True}, "lossless", 1),
            ({"quality": 100}, "lossy", 12),
            ({"quality": 100, "alpha_quality": 100, "method": 6}, "lossy, method 6", 12),
        ):
            out = io.BytesIO()
            image.save(out, "WEBP", **options)
            yield Sample("WebP", f"{mode}, {name}", "Pillow", ".webp", out.getvalue(), scaled(pixels), tolerance / 255)
        data = imagecodecs.webp_encode(pixels, lossless=True)
        yield Sample("WebP", f"{mode}, lossless", "imagecodecs", ".webp", data, scaled(pixels))
        out = io.BytesIO()
        image.save(out, "WEBP", save_all=True, append_images=[image.transpose(0), image], lossless=True, duration=100)
        yield Sample("WebP", f"{mode}, animation", "Pillow", ".webp", out.getvalue(), scaled(pixels))
        small = numpy.zeros((30, 50, 4), "u1")
        small[4:25, 6:43, :channels] = pixels
        small[4:25, 6:43, 3] = pixels[..., 3] if channels == 4 else 255
        out = io.BytesIO()
        Image.fromarray(small).save(
            out,
            "WEBP",
            save_all=True,
            append_images=[Image.fromarray(255 - small)],
            lossless=True,
            exact=True,
            minimize_size=True,
        )
        yield Sample(
            "WebP", f"{mode}, animation, the first frame a window", "Pillow", ".webp", out.getvalue(), scaled(small)
        )
