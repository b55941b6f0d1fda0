"""A picture in other codecs at a number of bytes, for perceptual.py and crops.py.

The codecs are those of Pillow and of the package pillow-jxl-plugin: libavif (speed 4, 4:2:0; its tune is that for images),
libwebp (method 6), libjxl (effort 7) and OpenJPEG (9/7 wavelet, colour transform).  "half" and "quarter" code the picture
at a half or a quarter of its width and height; what is decoded is enlarged to its size.
"""
import collections
import io

# How to save: Pillow's options; the picture is coded at 1 / reduction of its width and height.
Codec = collections.namedtuple("Codec", "options reduction")
AVIF = dict(format="AVIF", speed=4, subsampling="4:2:0", max_threads=1)
WEBP = dict(format="WEBP", method=6)
JPEG_XL = dict(format="JXL", effort=7)
JPEG_2000 = dict(format="JPEG2000", quality_mode="rates", irreversible=True, mct=1)
CODECS = {
    "AVIF": Codec(AVIF, 1), "AVIF half": Codec(AVIF, 2), "AVIF quarter": Codec(AVIF, 4),
    "WebP": Codec(WEBP, 1), "WebP half": Codec(WEBP, 2),
    "JPEG XL": Codec(JPEG_XL, 1), "JPEG XL half": Codec(JPEG_XL, 2), "JPEG XL quarter": Codec(JPEG_XL, 4),
    "JPEG 2000": Codec(JPEG_2000, 1),
}
AVIF_NAMES = [name for name, codec in CODECS.items() if codec.options is AVIF]
BEST_QUALITY = 99  # a quality of 100 is lossless JPEG XL, which has another interface
SMALLEST_FILE = 200  # bytes; JPEG 2000 has no file as small as this


class Picture:
    """A picture and its files in one codec."""

    def __init__(self, path, name):
        from PIL import Image  # only a run with other codecs needs Pillow
        how = CODECS[name]
        if how.options is JPEG_XL:
            import pillow_jxl  # noqa: F401 (adds the format to Pillow)
        self.options, self.image, self.lanczos = how.options, Image, Image.LANCZOS
        with Image.open(path) as source:
            self.source = source.convert("RGB")
        self.reduced = self.source if how.reduction == 1 else self.source.resize(
            [max(1, round(side / how.reduction)) for side in self.source.size], self.lanczos)
        self.files = {}  # by quality

    def save(self, **options):
        file = io.BytesIO()
        self.reduced.save(file, **self.options, **options)
        return file.getvalue()

    def encode(self, quality):
        if quality not in self.files:
            self.files[quality] = self.save(quality=quality)
        return self.files[quality]

    def encode_below(self, budget):
        """JPEG 2000 takes a number of bytes, and its file is a little larger or smaller."""
        target = budget
        while target >= SMALLEST_FILE:
            data = self.save(quality_layers=[3 * self.reduced.width * self.reduced.height / target])
            if len(data) <= budget:
                return [data]
            target -= len(data) - budget
        return []

    def around(self, budget):
        """The files on either side of a number of bytes, as `around` has them."""
        return self.encode_below(budget) if self.options is JPEG_2000 else around(self.encode, budget)

    def write_decoded(self, data, path):
        """Writes what a decoder shows of a file, at the size of the picture."""
        with self.image.open(io.BytesIO(data)) as opened:
            decoded = opened.convert("RGB")
        if decoded.size != self.source.size:
            decoded = decoded.resize(self.source.size, self.lanczos)
        decoded.save(path)


def around(encode, budget):
    """The largest file of at most `budget` bytes, and the next larger one where there is one; [] where no file is as small.
    `encode` gives the file of a quality, 0 to BEST_QUALITY."""
    if len(encode(0)) > budget:
        return []
    low, high = 0, BEST_QUALITY + 1
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if len(encode(middle)) <= budget else (low, middle)
    return [encode(quality) for quality in (low, high) if quality <= BEST_QUALITY]
