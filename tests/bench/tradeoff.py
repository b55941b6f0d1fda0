#!/usr/bin/env python3
"""The cost of accuracy in time, by `gscl tradeoff`: plots and tables.

    tests/bench/tradeoff.py [IMAGE] [--gscl build/gscl] [--document [ACCURACY.md]] [--from FOLDER]

Without IMAGE the project's sample image is measured.  With --document the tables replace the section `tradeoff` of that
document, and the plots go into tests/bench/.  --from uses the results of an earlier `gscl tradeoff --out FOLDER`.  The
machine should have no other load.
"""
import argparse
import json
import pathlib
import shutil
import subprocess
import tempfile

import document
from document import HERE, table

PLOTS = ("quality_time", "quality_rate", "accuracy", "gradients")
BLENDS = ("normalized", "alpha", "sum")
# Rows of the table: the choice, its variants, and the error that is shown.
ROWS = (("support", ("3 sigma", "3.74 sigma", "4.5 sigma", "6 sigma"), "mean_error_255"),
        ("exponential", ("polynomial", "exp2", "native_exp2"), "largest_error_255"),
        ("precision", ("float32", "float64"), "largest_error_255"),
        ("early stop", ("off", "below 1/1024", "below 1/255"), "largest_error_255"))
STEPS = ("steps x0.5", "steps x0.7", "steps x1", "steps x1.4", "steps x2")


def make_sample(gscl, folder):
    build = pathlib.Path(gscl).parent
    subprocess.run(["ninja", "-C", build, "tests/sample/make_sample"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([build / "tests/sample/make_sample", folder / "sample.png"], check=True)
    return folder / "sample.png"


def measure(arguments, folder):
    """Returns the folder of the results."""
    if arguments.from_folder:
        return pathlib.Path(arguments.from_folder)
    image = arguments.image or make_sample(arguments.gscl, folder)
    subprocess.run([arguments.gscl, "tradeoff", image, "--out", folder / "tradeoff"], check=True, stdout=subprocess.DEVNULL)
    return folder / "tradeoff"


def across_blends(rows, write):
    """One cell for all blends; a dash for a blend that lacks the choice."""
    found = {row["blend"]: row for row in rows}
    return ", ".join(write(found[blend]) if blend in found else "-" for blend in BLENDS)


def variant_name(variant, row):
    return f"**{variant}**" if row["default"] else variant


def accuracy_rows(accuracy):
    for choice, variants, error in ROWS:
        for variant in variants:
            rows = [row for row in accuracy if (row["choice"], row["variant"]) == (choice, variant)]
            if rows:  # none on a device without doubles
                yield (choice, variant_name(variant, rows[0]), across_blends(rows, lambda row: f"{row[error]:.2g}"),
                       across_blends(rows, lambda row: f"{row['ns_per_pixel']:.1f}"))


def quantiser_rows(accuracy):
    for variant in STEPS:
        rows = {row["blend"]: row for row in accuracy if (row["choice"], row["variant"]) == ("quantiser", variant)}
        yield (variant_name(variant, rows["normalized"]),
               *(f"{rows[blend][key]:.2f}" for blend in ("normalized", "sum")
                 for key in ("bits_per_splat", "psnr", "psnr_same_size")))


def section_parts(report):
    yield document.origin("tests/bench/tradeoff.py", 1)
    yield f"Device: {report['device']}.\n"
    yield table(("choice", "", f"error in 1/255: {', '.join(BLENDS)}", f"ns per pixel: {', '.join(BLENDS)}"),
                accuracy_rows(report["accuracy"]))
    yield table(("quantiser steps", "normalized: bits per splat", "dB, rounded", "dB, encoded", "sum: bits per splat",
                 "dB, rounded", "dB, encoded"), quantiser_rows(report["accuracy"]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("image", nargs="?", help="image to measure (default: the project's sample image)")
    parser.add_argument("--gscl", default="build/gscl", help="program to measure (default %(default)s)")
    document.add_option(parser, "ACCURACY.md", "tradeoff")
    parser.add_argument("--from", dest="from_folder", metavar="FOLDER", help="folder of an earlier gscl tradeoff")
    arguments = parser.parse_args()
    section = document.section_of(arguments)
    with tempfile.TemporaryDirectory() as folder:
        results = measure(arguments, pathlib.Path(folder))
        report = json.loads((results / "tradeoff.json").read_text(encoding="utf-8"))
        if section:
            for name in PLOTS:
                shutil.copyfile(results / f"{name}.svg", HERE / f"tradeoff_{name}.svg")
    document.publish(section, *section_parts(report))


if __name__ == "__main__":
    main()
