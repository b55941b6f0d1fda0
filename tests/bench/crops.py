#!/usr/bin/env python3
"""A page of crops of pictures at equal bytes, to be judged by eye: the original, gscl and the best AVIF.

    sh tests/bench/bench.sh crops FOLDER --out DIR [--gscl build/gscl] [--only NAMES] [--bytes 2064,6144]
        [--variant "OPTIONS"]... [--size 256]

Writes DIR/index.html, which holds all that it shows, and one PNG file for each row of crops.  The crops have their real size.
Each picture has three: where texture is everywhere, where edges are strongest, and where it is flattest.  Each --variant is a
set of options of `gscl encode`.  The AVIF is that with the best SSIMULACRA 2 of the files within the budget at full, half and
quarter size (other_codecs.py).  The measures are those of `gscl compare` for the whole picture.
"""
import base64
import collections
import html
import io
import pathlib
import tempfile

import numpy
from PIL import Image

import codec
import other_codecs

STEP = 16  # pixels between the places that a crop may have
OVERLAP = 0.25  # of a crop's area that another crop may share, where the picture allows it
GAP = 8  # pixels between the crops of a row's PNG file
STYLE = """body { font-family: sans-serif; margin: 16px; background: #808080; color: #000 }
table { border-spacing: 8px } td { vertical-align: top } img { display: block; image-rendering: pixelated }
p { margin: 4px 0; font-size: 13px }"""

# One way of coding a picture: its name, its bytes (None for the original), `gscl compare` against the original, its pixels.
Version = collections.namedtuple("Version", "name bytes measures pixels")


def load(path):
    with Image.open(path) as opened:
        return opened.convert("RGB")


def detail_of(picture):
    """The size of the brightness gradient at each pixel."""
    grey = numpy.asarray(picture.convert("L"), dtype=float)
    down, right = numpy.gradient(grey)
    return numpy.hypot(down, right)


# By name of a crop: how well a place with such gradients suits it.
KINDS = {
    "texture": lambda detail: numpy.median(detail),
    "edges": lambda detail: numpy.percentile(detail, 98) - 2 * numpy.median(detail),
    "flat": lambda detail: -numpy.percentile(detail, 90),
}


def overlap(a, b, size):
    """The share of a crop's area that lies in another crop."""
    width, height = (max(0, side - abs(p - q)) for side, p, q in zip(size, a, b))
    return width * height / (size[0] * size[1])


def places_of(picture, size):
    """By kind of crop: its left and upper pixel."""
    detail = detail_of(picture)
    candidates = [(x, y) for y in range(0, picture.height - size[1] + 1, STEP) for x in range(0, picture.width - size[0] + 1, STEP)]
    places = {}
    for kind, suits in KINDS.items():
        free = [at for at in candidates if all(overlap(at, other, size) <= OVERLAP for other in places.values())]
        places[kind] = max(free or candidates, key=lambda at: suits(detail[at[1]:at[1] + size[1], at[0]:at[0] + size[0]]))
    return places


def version_of(arguments, name, path, image, size):
    return Version(name, size, codec.compare(arguments.gscl, image, path), load(path))


def code_gscl(arguments, variant, image, budget, work):
    size, decoded = codec.code_variant(arguments.gscl, variant, image, budget, work)
    return version_of(arguments, codec.name_of(variant), decoded, image, size)


def code_avif(arguments, pictures, image, budget, work):
    """The best AVIF within the budget; None where no size has a file as small."""
    versions = []
    for name, picture in pictures.items():
        for data in picture.around(budget)[:1]:
            picture.write_decoded(data, work / "image.png")
            versions.append(version_of(arguments, name, work / "image.png", image, len(data)))
    return max(versions, key=lambda version: version.measures["ssimulacra2"], default=None)


def versions_of(arguments, image, pictures, budget, work):
    versions = [Version("original", None, {}, load(image))]
    versions += [code_gscl(arguments, variant, image, budget, work) for variant in arguments.variants]
    best = code_avif(arguments, pictures, image, budget, work)
    return [*versions, best] if best else versions


def crop_of(version, at, size):
    return version.pixels.crop((*at, at[0] + size[0], at[1] + size[1]))


def figures_of(version):
    if version.bytes is None:
        return ""
    measures = version.measures
    return (f"{version.bytes} bytes, SSIMULACRA 2 {measures['ssimulacra2']:.1f}, PSNR {measures['psnr']:.2f} dB, "
            f"MS-SSIM {measures['ms_ssim']:.3f}")


def cell_of(version, at, size):
    file = io.BytesIO()
    crop_of(version, at, size).save(file, format="PNG")
    data = base64.b64encode(file.getvalue()).decode("ascii")
    name = html.escape(version.name)
    return (f'<td style="width: {size[0]}px"><img width="{size[0]}" height="{size[1]}" alt="{name}" '
            f'src="data:image/png;base64,{data}"><p><b>{name}</b></p><p>{figures_of(version)}</p></td>')


def write_row(versions, at, size, path):
    """The crops of a row beside each other."""
    row = Image.new("RGB", ((size[0] + GAP) * len(versions) - GAP, size[1]), (128, 128, 128))
    for i, version in enumerate(versions):
        row.paste(crop_of(version, at, size), (i * (size[0] + GAP), 0))
    row.save(path)


def picture_rows(arguments, image, work):
    """The part of the page for one picture."""
    source = load(image)
    size = [min(arguments.size, side) for side in source.size]
    places = places_of(source, size)
    pictures = {name: other_codecs.Picture(image, name) for name in other_codecs.AVIF_NAMES}
    parts = []
    for budget in arguments.budgets:
        versions = versions_of(arguments, image, pictures, budget, work)
        parts.append(f"<h2>{html.escape(image.stem)}, {budget} bytes</h2>")
        for kind, at in places.items():
            write_row(versions, at, size, arguments.out / f"{image.stem}-{budget}-{kind}.png")
            cells = "\n".join(cell_of(version, at, size) for version in versions)
            parts.append(f"<p>{kind}, from pixel {at[0]}, {at[1]}</p>\n<table><tr>\n{cells}\n</tr></table>")
    return "\n".join(parts)


def write_page(title, rows, out):
    """Writes index.html into the folder `out`, and prints its name."""
    page = "\n".join(['<!DOCTYPE html>', f'<html lang="en"><head><meta charset="utf-8"><title>{title}</title>',
                      f"<style>\n{STYLE}\n</style></head><body>", f"<h1>{title}</h1>", *rows, "</body></html>", ""])
    (out / "index.html").write_text(page, encoding="utf-8")
    print(out / "index.html")


def parse():
    parser = codec.parser(__doc__)
    parser.add_argument("--out", required=True, type=pathlib.Path, help="folder for the page; it is made if it is missing")
    codec.add_variants(parser, "2064,6144")
    parser.add_argument("--size", type=int, default=256, help="sides of a crop, pixels (default %(default)s)")
    return codec.parse_variants(parser)


def main():
    arguments = parse()
    images = codec.images_of(arguments.folder, arguments.only)
    arguments.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        rows = [picture_rows(arguments, image, pathlib.Path(folder)) for image in images]
    write_page("Crops at equal bytes", rows, arguments.out)


if __name__ == "__main__":
    main()
