#!/usr/bin/env python3
"""Files of 30 to 1000 bytes: gscl beside AVIF without its container and ThumbHash, as a Markdown table of means.

    sh tests/bench/bench.sh tiny FOLDER [--gscl build/gscl] [--only NAMES] [--bytes 30,60,100,150,300,500,1000]
        [--variant "OPTIONS"]... [--csv FILE] [--document [RESULTS.md]]

Each --variant is a set of options of `gscl encode`.  AVIF codes the picture at several smaller sizes; of those whose coded
image, the content of its box `mdat`, fits into the bytes, the best one of each picture counts, by each measure by itself.
Some 270 bytes of its container are thus given away.  What a codec decodes is enlarged to the size of the picture by a
Lanczos filter.  A ThumbHash has a size of its own, which the table names; the files of gscl beside it have the same size.
"""
import struct

import codec
import document
import other_codecs

LONGER_SIDES = (16, 24, 32, 48, 64, 96, 128, 192, 256, 384)  # pixels, of the shrunken picture
THUMB_SIDE = 100  # pixels; a ThumbHash is made of a picture of at most this size
KEYS = {"psnr": (2, "PSNR dB"), "ms_ssim": (4, "MS-SSIM"), "ssimulacra2": (1, "SSIMULACRA 2")}
AVIF, THUMBHASH = "AVIF, shrunken, without container", "ThumbHash"


def payload_size(data):
    """Bytes of the content of the box `mdat` of an AVIF file."""
    at = 0
    while at + 8 <= len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"mdat":
            return size - 8 if size else len(data) - at - 8  # 0: up to the end of the file
        if size < 8:
            break
        at += size
    raise SystemExit("an AVIF file of Pillow has no box mdat")


class Shrunken(other_codecs.Picture):
    """A picture as AVIF of a smaller size."""

    def __init__(self, path, longer_side):
        super().__init__(path, "AVIF")
        scale = longer_side / max(self.source.size)
        self.reduced = self.source.resize([max(1, round(side * scale)) for side in self.source.size], self.lanczos)

    def largest_within(self, budget):
        """The largest file whose payload has at most `budget` bytes; None where none is as small."""
        low, high = -1, other_codecs.BEST_QUALITY + 1
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if payload_size(self.encode(middle)) <= budget else (low, middle)
        return None if low < 0 else self.encode(low)


def measure_avif(arguments, image, sizes, budget, work):
    """The best figures of all sizes, each measure by itself; None where none fits."""
    rows = []
    for picture in sizes:
        data = picture.largest_within(budget)
        if data:
            picture.write_decoded(data, work / "image.png")
            measures = codec.compare(arguments.gscl, image, work / "image.png")
            rows.append(dict(bytes=payload_size(data), **{key: measures[key] for key in KEYS}))
    return {key: max(row[key] for row in rows) for key in rows[0]} if rows else None


def thumb_hash(path, work):
    """Bytes of the ThumbHash of a picture; writes what it shows to work/image.png."""
    import fast_thumbhash  # only a run of this script needs it
    from PIL import Image
    with Image.open(path) as opened:
        source = opened.convert("RGB")
    small = source.copy()
    small.thumbnail((THUMB_SIDE, THUMB_SIDE), Image.LANCZOS)
    rgba = small.convert("RGBA")
    code = bytes(fast_thumbhash.rgba_to_thumb_hash(rgba.width, rgba.height, rgba.tobytes()))
    width, height, pixels = fast_thumbhash.thumb_hash_to_rgba(code)
    shown = Image.frombytes("RGBA", (width, height), bytes(pixels)).convert("RGB")
    shown.resize(source.size, Image.LANCZOS).save(work / "image.png")
    return len(code)


def measure_gscl(arguments, variant, image, budget, work):
    size, decoded = codec.code_variant(arguments.gscl, variant, image, budget, work)
    measures = codec.compare(arguments.gscl, image, decoded)
    return dict(bytes=size, **{key: measures[key] for key in KEYS})


def measure_thumb_hash(arguments, image, work):
    """Rows of the ThumbHash of an image and of gscl at its size; the bare form, as a ThumbHash has no container either."""
    size = thumb_hash(image, work)
    measures = codec.compare(arguments.gscl, image, work / "image.png")
    first = dict(codec=THUMBHASH, image=image.stem, budget=0, bytes=size, **{key: measures[key] for key in KEYS})
    variants = [variant if "--bare" in variant else f"{variant} --bare" for variant in arguments.variants]
    return [first, *(dict(codec=codec.name_of(variant), image=image.stem, budget=0,
                          **measure_gscl(arguments, variant, image, size, work)) for variant in dict.fromkeys(variants))]


def measure_image(arguments, image, work):
    sizes = [Shrunken(image, side) for side in LONGER_SIDES]
    rows = measure_thumb_hash(arguments, image, work)
    for budget in arguments.budgets:
        measured = {codec.name_of(variant): measure_gscl(arguments, variant, image, budget, work) for variant in arguments.variants}
        measured[AVIF] = measure_avif(arguments, image, sizes, budget, work)
        rows += [dict(codec=name, image=image.stem, budget=budget, **row) for name, row in measured.items() if row]
    return rows


def table_of(rows, images):
    """A row for each size and codec, with how many images the codec reaches where these are not all."""
    lines = []
    for budget, name in dict.fromkeys((row["budget"], row["codec"]) for row in sorted(rows, key=lambda row: row["budget"])):
        own = [row for row in rows if (row["budget"], row["codec"]) == (budget, name)]
        size = f"{codec.mean(own, 'bytes'):.0f} (its own)" if budget == 0 else str(budget)
        reached = "" if len(own) == images else f" ({len(own)} of {images})"
        lines.append([size, name + reached, *(f"{codec.mean(own, key):.{digits}f}" for key, (digits, _) in KEYS.items())])
    return document.table(["bytes", "codec", *(title for _, title in KEYS.values())], lines)


def main():
    parser = codec.parser(__doc__)
    codec.add_variants(parser, "30,60,100,150,300,500,1000")
    parser.add_argument("--csv", help="file for one row per image, size and codec")
    document.add_option(parser, "RESULTS.md", "tiny")
    arguments = codec.parse_variants(parser)
    section = document.section_of(arguments)
    images = codec.images_of(arguments.folder, arguments.only)
    rows = codec.measured(arguments, images, measure_image)
    document.publish(section, document.origin("sh tests/bench/bench.sh tiny FOLDER", len(images)), table_of(rows, len(images)))


if __name__ == "__main__":
    main()
