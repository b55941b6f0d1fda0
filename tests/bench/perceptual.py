#!/usr/bin/env python3
"""Perceptual quality of gscl beside AVIF, WebP, JPEG XL and JPEG 2000 at the same number of bytes: a plot and tables.

    sh tests/bench/bench.sh perceptual FOLDER [--gscl build/gscl] [--only NAMES] [--bytes 2064,3244,6144,8994]
        [--variant "OPTIONS"]... [--codecs NAMES] [--csv FILE] [--plot FILE.svg] [--document [RESULTS.md]]

The folder holds PNG images of 8-bit RGB.  Each --variant is a set of options of `gscl encode`; the first one is compared with
all others.  Most other codecs have a coarse scale of quality: their figures are interpolated in the logarithm of the size
between the largest file within the budget and the next larger one.  other_codecs.py says how they are used.  "best AVIF"
takes, for each image, the AVIF of the three sizes with the best SSIMULACRA 2.

SSIMULACRA 2 and PSNR are those of `gscl compare`.  Butteraugli is its 3-norm by `butteraugli_main` (Debian: libjxl-devtools),
DSSIM is that of the program `dssim` (crates.io), times 1000; bench.sh installs both.
"""
import csv
import math
import pathlib
import re
import shutil
import subprocess

import codec
import document
import other_codecs

# By column: title and digits.
METRICS = {"ssimulacra2": ("SSIMULACRA 2, higher is better", 1), "butteraugli": ("Butteraugli 3-norm, lower is better", 2),
           "dssim": ("DSSIM x 1000, lower is better", 1), "psnr": ("PSNR dB", 2)}
BEST_AVIF = "best AVIF"
PROGRAMS = {"butteraugli_main": "Debian's package libjxl-devtools", "dssim": "`cargo install dssim`"}


def programs():
    """The paths of the programs that measure."""
    found = {name: shutil.which(name) for name in PROGRAMS}
    for name, path in found.items():
        if not path:
            raise SystemExit(f"{name}: not found; it comes with {PROGRAMS[name]}, or run sh tests/bench/bench.sh perceptual")
    return found


def figure_of(pattern, *words):
    """The number that a program prints."""
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    match = re.search(pattern, done.stdout)
    if done.returncode or not match:
        raise SystemExit(f"{' '.join(map(str, words))}: {(done.stderr or done.stdout).strip() or 'printed no figure'}")
    return float(match[1])


def scores(arguments, image, decoded):
    """All metrics of a decoded image."""
    measures = codec.compare(arguments.gscl, image, decoded)
    return {"ssimulacra2": measures["ssimulacra2"],
            "butteraugli": figure_of(r"3-norm: (\S+)", arguments.programs["butteraugli_main"], image, decoded),
            "dssim": 1000 * figure_of(r"(?m)^(\S+)\t", arguments.programs["dssim"], image, decoded),
            "psnr": measures["psnr"]}


def measure_gscl(arguments, variant, image, budget, work):
    size, decoded = codec.code_variant(arguments.gscl, variant, image, budget, work)
    return dict(bytes=size, **scores(arguments, image, decoded))


def measure_other(arguments, picture, image, budget, work):
    """The figures at the budget; None where no file is as small."""
    points = []
    for data in picture.around(budget):
        picture.write_decoded(data, work / "image.png")
        points.append((len(data), scores(arguments, image, work / "image.png")))
    if not points:
        return None
    size, first = points[0]
    if len(points) == 1:
        return dict(bytes=size, **first)
    return dict(bytes=size, **{key: codec.at_rate([(size, first[key]) for size, first in points], budget) for key in METRICS})


def best_of(rows):
    """The row with the best SSIMULACRA 2."""
    return max(rows, key=lambda row: row["ssimulacra2"], default=None)


def measure_image(arguments, image, work):
    """Rows of one image."""
    pictures = {name: other_codecs.Picture(image, name) for name in arguments.codecs}
    rows = []
    for budget in arguments.budgets:
        measured = {codec.name_of(variant): measure_gscl(arguments, variant, image, budget, work) for variant in arguments.variants}
        measured.update({name: measure_other(arguments, picture, image, budget, work) for name, picture in pictures.items()})
        best = best_of([measured[name] for name in other_codecs.AVIF_NAMES if measured.get(name)])
        rows += [dict(codec=name, image=image.stem, budget=budget, **row)
                 for name, row in [*measured.items(), (BEST_AVIF, best)] if row]
    return rows


def by_codec(rows, budget, key):
    """By codec and image: the figures at one budget."""
    figures = {}
    for row in rows:
        if row["budget"] == budget and not math.isnan(row[key]):
            figures.setdefault(row["codec"], {})[row["image"]] = row[key]
    return figures


def mean_of(values):
    values = list(values)
    return sum(values) / len(values)


def mean_cell(values, images, digits):
    if not values:
        return "-"
    reached = "" if len(values) == images else f" ({len(values)})"
    return f"{mean_of(values.values()):.{digits}f}{reached}"


def mean_table(rows, names, budgets, key, images):
    title, digits = METRICS[key]
    figures = {budget: by_codec(rows, budget, key) for budget in budgets}
    return document.table([title, *map(str, budgets)],
                          [[name, *(mean_cell(figures[budget].get(name, {}), images, digits) for budget in budgets)]
                           for name in names])


def difference_cell(ours, theirs):
    """Mean difference over the images that the other codec reaches, and how many of them are won."""
    differences = [ours[image] - theirs[image] for image in theirs if image in ours]
    if not differences:
        return "-"
    return f"{mean_of(differences):+.1f} ({sum(difference > 0 for difference in differences)} of {len(differences)})"


def difference_table(rows, names, budgets):
    """Differences of the first variant in SSIMULACRA 2 to all others."""
    figures = [by_codec(rows, budget, "ssimulacra2") for budget in budgets]
    return document.table([f"SSIMULACRA 2 of {names[0]} (images won)", *map(str, budgets)],
                          [[f"against {name}", *(difference_cell(at.get(names[0], {}), at.get(name, {})) for at in figures)]
                           for name in names[1:]])


def line_style(name, variants):
    """Codecs have colours, reduced sizes have dashes, variants of gscl are wide."""
    colours = {"AVIF": "tab:purple", "WebP": "tab:green", "JPEG XL": "tab:brown", "JPEG 2000": "tab:blue"}
    if name in variants:
        reds = ("tab:red", "tab:orange", "tab:pink", "tab:olive")
        return dict(color=reds[variants.index(name) % len(reds)], linewidth=2.2)
    family = next((family for family in colours if name.startswith(family)), None)
    return dict(color=colours.get(family), linewidth=1.3, linestyle={"half": "--", "quarter": ":"}.get(name.split()[-1], "-"))


def draw(rows, names, variants, budgets, images, path):
    """A curve has the budgets at which the codec has a file of every image."""
    import plots  # only a run with a plot needs matplotlib
    figure, axes = plots.pyplot.subplots(1, 3, figsize=(14, 4.3), constrained_layout=True)
    for axis, key in zip(axes, METRICS):
        for name in names:
            figures = {budget: by_codec(rows, budget, key).get(name, {}) for budget in budgets}
            curve = [(budget, mean_of(values.values())) for budget, values in figures.items() if len(values) == images]
            if curve and name != BEST_AVIF:
                axis.plot(*zip(*curve), label=name, marker="o", markersize=3, **line_style(name, variants))
        axis.set(xscale="log", xlabel="bytes", title=METRICS[key][0])
        axis.set_xticks(budgets, map(str, budgets))
        axis.minorticks_off()
        axis.grid(True, alpha=0.3)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside right center", fontsize="small")
    plots.save(figure, path)


def parse():
    parser = codec.parser(__doc__)
    codec.add_variants(parser, "2064,3244,6144,8994")
    parser.add_argument("--codecs", default=",".join(other_codecs.CODECS), help="other codecs (default %(default)s)")
    parser.add_argument("--csv", help="file for one row per image, size and codec")
    parser.add_argument("--plot", help="plot to write (default: perceptual.svg beside the document, if one is given)")
    document.add_option(parser, "RESULTS.md", "perceptual")
    arguments = codec.parse_variants(parser)
    arguments.codecs = [name for name in arguments.codecs.split(",") if name]
    unknown = [name for name in arguments.codecs if name not in other_codecs.CODECS]
    if unknown:
        raise SystemExit(f"--codecs: no codec is called {unknown[0]}; there are {', '.join(other_codecs.CODECS)}")
    arguments.programs = programs()
    return arguments


def main():
    arguments = parse()
    section = document.section_of(arguments)
    images = codec.images_of(arguments.folder, arguments.only)
    rows = codec.measured(arguments, images, measure_image)
    variants, budgets = [codec.name_of(variant) for variant in arguments.variants], arguments.budgets
    present = {row["codec"] for row in rows}
    names = [name for name in [*variants, *arguments.codecs, BEST_AVIF] if name in present]
    plot = arguments.plot or (section.path.parent / "perceptual.svg" if section else None)
    if plot:
        draw(rows, names, variants, budgets, len(images), plot)
    document.publish(section, document.origin("sh tests/bench/bench.sh perceptual FOLDER", len(images)),
                     *([f"![Perceptual quality against bytes]({pathlib.Path(plot).name})\n"] if section else []),
                     *(mean_table(rows, names, budgets, key, len(images)) for key in METRICS),
                     difference_table(rows, names, budgets))


if __name__ == "__main__":
    main()
