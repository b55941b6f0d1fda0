#!/usr/bin/env python3
"""Trains the tables of the format on gscl files, and measures what they gain on others:

    tests/bench/train_tables.py FOLDER            writes format/tables.c and the section "Trained tables" of FORMAT.md
    tests/bench/train_tables.py --gain FOLDER...  bits a splat with and without each table, for each folder

A folder is searched for files *.gscl of the default profile.  corpus.py collects the pictures to encode.  Training goes
round in circles, because the encoder chooses codes that the tables make cheap: encode the corpus with the present
tables, train, build, and encode again.
"""
import argparse
import math
import pathlib
import sys

import numpy
from scipy.optimize import minimize
from scipy.special import betaln, gammaln

HERE = pathlib.Path(__file__).resolve().parent
FORMAT = HERE.parent.parent / "format"
sys.path.insert(0, str(HERE.parent / "decoder"))
import gscl_decoder  # noqa: E402

ASPECTS, DIRECTIONS, SIZE_ROWS, CLASS_ROWS = 24, 16, 24, 40
BELOW, CLASS_BELOW = 10, 12  # smallest relative sizes that have a row of their own
FLAT_CLASSES = (2, 40000)    # weights in 1/64 where the corpus has next to no splats


def read_folder(folder):
    """Pictures of scalar coding with splats, as the second decoder reads them."""
    pictures = []
    for path in sorted(pathlib.Path(folder).rglob("*.gscl")):
        picture = gscl_decoder.decode(path.read_bytes())
        if picture.coding == gscl_decoder.SCALAR and picture.n > 0:
            pictures.append(picture)
    if not pictures:
        sys.exit(f"{folder}: has no gscl file of the default profile with splats; encode some first")
    return pictures


def sizes(picture):
    return numpy.array([s.major for s in picture.splats]) - picture.typical()


def size_rows(picture):
    return numpy.clip(sizes(picture) + BELOW, 0, SIZE_ROWS - 1)


def attribute(picture, name):
    return numpy.array([getattr(s, name) for s in picture.splats])


def bins(picture):
    """Rows and bins of the angles that have at least 8 codes."""
    aspect, angle = attribute(picture, "aspect"), attribute(picture, "angle")
    count = numpy.array([picture.angle_count(a) for a in range(64)])[aspect]
    used = count >= 8
    return numpy.minimum(aspect // 2, 7)[used], ((32 * angle + count) // (2 * count) % DIRECTIONS)[used]


def class_observations(picture):
    """Rows, splats of the class, and splats of it and the classes after it."""
    counts, left, rows = numpy.bincount(attribute(picture, "major"), minlength=64), picture.n, []
    for major in range(63, 0, -1):
        if left == 0:
            break
        rows.append((min(max(major - picture.typical() + CLASS_BELOW, 0), CLASS_ROWS - 1), counts[major], left))
        left -= counts[major]
    return rows


# ---- Samples of each model: rows and symbols -------------------------------------------------------------------------

def samples(picture, model):
    rows, amplitude = size_rows(picture), attribute(picture, "amplitude")
    textured = amplitude > 0
    zeros = numpy.zeros(int(textured.sum()), int)
    return {
        "aspect": lambda: (rows, numpy.minimum(attribute(picture, "aspect"), ASPECTS - 1)),
        "direction": lambda: bins(picture),
        "textured": lambda: (rows // 2, textured.astype(int)),
        "amplitude": lambda: (zeros, amplitude[textured] - 1),
        "wave": lambda: (zeros, attribute(picture, "wave")[textured]),
    }[model]()


# Rows, symbols, sum of a row of start values, kernels over rows and symbols, whether symbols are cyclic, gains.
MODELS = {
    "aspect": (SIZE_ROWS, ASPECTS, 300, (1, .5, .2), (.8, .1), False, (4, 2, 1)),
    "direction": (8, DIRECTIONS, 300, (1, .3), (1, 0), True, (7, 1, 0)),
    "textured": (12, 2, 100, (1, .3), (1, 0), False, (10, 0, 0)),
    "amplitude": (1, 16, 120, (1,), (.8, .1), False, (5, 2, 1)),
    "wave": (1, 16, 120, (1,), (.6, .2), False, (5, 2, 0)),
}


def smooth(histogram, over_rows, over_symbols, cyclic):
    rows = numpy.zeros_like(histogram)
    for distance in range(1 - len(over_rows), len(over_rows)):
        source = histogram[max(distance, 0):len(histogram) + min(distance, 0)]
        rows[max(-distance, 0):len(histogram) - max(distance, 0)] += over_rows[abs(distance)] * source
    ends = numpy.pad(rows, ((0, 0), (1, 1)), "wrap" if cyclic else "edge")
    return over_symbols[0] * rows + over_symbols[1] * (ends[:, :-2] + ends[:, 2:])


def train_rows(pictures, model):
    """Each picture weighs as the square root of its number of splats, so that large files do not decide alone."""
    rows, symbols, total, over_rows, over_symbols, cyclic, _ = MODELS[model]
    histogram = numpy.zeros((rows, symbols))
    for picture in pictures:
        numpy.add.at(histogram, samples(picture, model), 1 / math.sqrt(picture.n))
    start = smooth(histogram, over_rows, over_symbols, cyclic) + .5 * histogram.sum(0) / histogram.sum() + .02 / symbols
    start /= start.sum(1, keepdims=True)
    return numpy.maximum(1, numpy.round(start * total)).astype(int)


def split_bits(k, n, a, b):
    return -(gammaln(n + 1) - gammaln(k + 1) - gammaln(n - k + 1) + betaln(k + a, n - k + b) - betaln(a, b)) / math.log(2)


def train_classes(pictures):
    """The maximum-likelihood weights of each row, in 1/64."""
    seen = numpy.array([row for picture in pictures for row in class_observations(picture)], float)
    weights = []
    for row in range(CLASS_ROWS):
        k, n = seen[seen[:, 0] == row, 1:].T
        if len(k) < 8 or (row > 2 * CLASS_BELOW and k.sum() == 0):
            weights.append(FLAT_CLASSES if row > CLASS_BELOW else weights[-1] if weights else (64, 64))
            continue
        cost = lambda p: split_bits(k, n, *numpy.exp(p)).sum() + .05 * (p ** 2).sum()
        a, b = 64 * numpy.exp(minimize(cost, [0., 1.], method="Nelder-Mead", options={"maxiter": 300}).x)
        shrink = max(1, a / 60000, b / 60000)
        weights.append((max(1, round(a / shrink)), max(64, round(b / shrink))))
    return numpy.array(weights)


def train(pictures):
    return {**{model: train_rows(pictures, model) for model in MODELS}, "class": train_classes(pictures)}


# ---- Output ----------------------------------------------------------------------------------------------------------

def lines(values, per_line, separator=" "):
    values = [str(v) for v in values]
    return ["    " + separator.join(values[i:i + per_line]) for i in range(0, len(values), per_line)]


def write_c(tables):
    sizes_of = {"aspect": "GSF_ASPECT_ROWS * GSF_ASPECT_COLUMNS", "direction": "GSF_DIRECTION_ROWS * GSF_DIRECTION_COLUMNS",
                "textured": "GSF_TEXTURED_ROWS * 2", "amplitude": "16", "wave": "16"}
    text = ['#include "format/tables.h"', ""]
    for model, size in sizes_of.items():
        text += [f"const uint8_t gsf_{model}_table[{size}] = {{"]
        text += [line + "," for line in lines(tables[model].ravel(), 24, ", ")] + ["};", ""]
    pairs = [f"{{{a}, {b}}}" for a, b in tables["class"]]
    text += ["const uint16_t gsf_class_weight_table[GSF_CLASS_ROWS][2] = {"]
    text += [line + "," for line in lines(pairs, 8, ", ")] + ["};", ""]
    (FORMAT / "tables.c").write_text("\n".join(text))


def page_rows(*tables, per_line):
    """Rows as the page has them: several on a line, separated by `|`."""
    rows = [" ".join(map(str, row)) for table in tables for row in table]
    return lines(rows, per_line, "  |  ")


def write_page(tables):
    section = ["## Trained tables", "", 'Rows are separated by `|` and by line feeds. With size = size_row of "Class counts", '
               "clamped to -10..13 (class weights: -12..27):", ""]
    section += ["    # aspect, rows size + 10 = 0..23"] + page_rows(tables["aspect"], per_line=2)
    section += ["    # direction, rows min(aspect / 2, 7) = 0..7"] + page_rows(tables["direction"], per_line=2)
    section += ["    # textured, rows (size + 10) / 2 = 0..11"] + page_rows(tables["textured"], per_line=12)
    section += ["    # amplitude; wave"] + page_rows(tables["amplitude"], tables["wave"], per_line=2)
    section += ["    # class weights A B, rows size + 12 = 0..39"] + page_rows(tables["class"], per_line=10) + ["", ""]
    page = (FORMAT / "FORMAT.md").read_text()
    start = page.index("## Trained tables")
    end = page.index("\n## ", start) + 1
    (FORMAT / "FORMAT.md").write_text(page[:start] + "\n".join(section) + page[end:])


# ---- Gain ------------------------------------------------------------------------------------------------------------

def adaptive_bits(rows, symbols, start, gains, cyclic):
    """The bits of the symbols by a conditional model that starts from these frequencies."""
    model = gscl_decoder.ConditionalModel([[int(v) for v in row] for row in start], gains, cyclic)
    bits = 0.
    for row, symbol in zip(rows, symbols):
        bits -= math.log2(model.f[row][symbol] / sum(model.f[row]))
        model.update(int(row), int(symbol))
    return bits


def gain(pictures, tables):
    """Mean bits a splat of each part: with equal start values in one row, and with the tables."""
    result = {}
    for model, (_, symbols, total, _, _, cyclic, gains) in MODELS.items():
        flat = numpy.full((1, symbols), max(1, total // symbols))
        both = []
        for picture in pictures:
            rows, coded = samples(picture, model)
            both.append((adaptive_bits(0 * rows, coded, flat, gains, cyclic) / picture.n,
                         adaptive_bits(rows, coded, tables[model], gains, cyclic) / picture.n))
        result[model] = numpy.mean(both, 0)
    result["class counts"] = numpy.mean([class_bits(picture, tables["class"]) for picture in pictures], 0) 
    return result


def halving_bits(counts, n):
    """The bits of class counts by halving, as where there is no table (FORMAT.md, "Class counts")."""
    if len(counts) == 1 or n == 0:
        return 0.
    half = len(counts) // 2
    left = counts[:half].sum()
    return (split_bits(left, n, 2. * half, 2. * (len(counts) - half)) + halving_bits(counts[:half], left) +
            halving_bits(counts[half:], n - left))


def class_bits(picture, weights):
    counts = numpy.bincount(63 - attribute(picture, "major"), minlength=64)
    used = numpy.flatnonzero(counts)
    flat = 6 + math.log2(64 - used[0]) + halving_bits(counts[used[0]:used[-1] + 1], picture.n)
    trained = sum(split_bits(k, n, *(weights[row] / 64)) for row, k, n in class_observations(picture))
    return flat / picture.n, trained / picture.n


def print_gain(folder, tables):
    pictures = read_folder(folder)
    print(f"\n{folder}: {len(pictures)} files, {numpy.mean([p.n for p in pictures]):.0f} splats in the mean; "
          "bits a splat with equal start values, with the tables, difference\n")
    print("| part | equal | tables | gain |\n|---|---|---|---|")
    rows = gain(pictures, tables)
    rows["all"] = sum(rows.values())
    for part, (flat, trained) in rows.items():
        print(f"| {part} | {flat:.3f} | {trained:.3f} | {flat - trained:.3f} |")


def present_tables():
    """The tables of the page."""
    return {model: numpy.array(table) for model, table in gscl_decoder.TABLES.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", metavar="FOLDER", nargs="+")
    parser.add_argument("--gain", action="store_true", help="measure the present tables instead of training new ones")
    arguments = parser.parse_args()
    if arguments.gain:
        for folder in arguments.folders:
            print_gain(folder, present_tables())
        return
    tables = train([picture for folder in arguments.folders for picture in read_folder(folder)])
    write_c(tables)
    write_page(tables)


if __name__ == "__main__":
    main()
