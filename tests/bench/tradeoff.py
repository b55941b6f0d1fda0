#!/usr/bin/env python3
"""What accuracy costs in time, by `gscl tradeoff`: the plots and the table of the README.

    tests/bench/tradeoff.py [IMAGE] [--gscl build/gscl] [--readme README.md] [--from FOLDER]

IMAGE is the project's sample picture when none is given.  With --readme the plots go to tests/bench/ and the table replaces
that between the marks <!-- tradeoff --> and <!-- /tradeoff --> of that file; else the table is printed.  --from takes what
`gscl tradeoff --out FOLDER` has measured before.  Wants a quiet machine.
"""
import argparse
import datetime
import json
import os
import pathlib
import shutil
import subprocess
import tempfile

PLOTS = ("quality_time", "quality_rate", "accuracy", "gradients")
BLENDS = ("normalized", "alpha", "sum")
# Rows of the table: what is varied, its variants, and the error that counts.
ROWS = (("support", ("3 sigma", "3.74 sigma", "4.5 sigma", "6 sigma"), "mean_error_255"),
        ("exponential", ("polynomial", "exp2", "native_exp2"), "largest_error_255"),
        ("precision", ("float32", "float64"), "largest_error_255"),
        ("early stop", ("off", "below 1/1024", "below 1/255"), "largest_error_255"))
STEPS = ("steps x0.5", "steps x0.7", "steps x1", "steps x1.4", "steps x2")
HERE = pathlib.Path(__file__).parent


def make_sample(gscl, folder):
    build = pathlib.Path(gscl).parent
    subprocess.run(["ninja", "-C", build, "tests/sample/make_sample"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([build / "tests/sample/make_sample", folder / "sample.png"], check=True)
    return folder / "sample.png"


def measure(arguments, folder):
    """Where the results lie."""
    if arguments.from_folder:
        return pathlib.Path(arguments.from_folder)
    image = arguments.image or make_sample(arguments.gscl, folder)
    subprocess.run([arguments.gscl, "tradeoff", image, "--out", folder / "tradeoff"], check=True, stdout=subprocess.DEVNULL)
    return folder / "tradeoff"


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def across_blends(rows, write):
    """One cell for all blends; a dash where a choice does not exist."""
    found = {row["blend"]: row for row in rows}
    return ", ".join(write(found[blend]) if blend in found else "-" for blend in BLENDS)


def accuracy_table(accuracy):
    for choice, variants, error in ROWS:
        for variant in variants:
            rows = [row for row in accuracy if (row["choice"], row["variant"]) == (choice, variant)]
            if not rows:
                continue  # a device without doubles
            name = f"**{variant}**" if rows[0]["default"] else variant
            yield (choice, name, across_blends(rows, lambda row: f"{row[error]:.2g}"),
                   across_blends(rows, lambda row: f"{row['ns_per_pixel']:.1f}"))


def quantiser_table(accuracy):
    for variant in STEPS:
        rows = {row["blend"]: row for row in accuracy if (row["choice"], row["variant"]) == ("quantiser", variant)}
        name = f"**{variant}**" if rows["normalized"]["default"] else variant
        yield (name, *(f"{rows[blend][key]:.2f}" for blend in ("normalized", "sum")
                       for key in ("bits_per_splat", "psnr", "psnr_same_size")))


def text_of(report):
    about = f"{datetime.date.today()}, {report['device']}, {len(os.sched_getaffinity(0))} cores; `tests/bench/tradeoff.py`.\n\n"
    errors = table(("choice", "", f"error in 1/255: {', '.join(BLENDS)}", f"ns per pixel: {', '.join(BLENDS)}"),
                   accuracy_table(report["accuracy"]))
    steps = table(("quantiser steps", "normalized: bits a splat", "dB, rounded", "dB, encoded", "sum: bits a splat", "dB, rounded",
                   "dB, encoded"), quantiser_table(report["accuracy"]))
    return about + errors + "\n" + steps


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("image", nargs="?")
    parser.add_argument("--gscl", default="build/gscl")
    parser.add_argument("--readme")
    parser.add_argument("--from", dest="from_folder", metavar="FOLDER")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        results = measure(arguments, pathlib.Path(folder))
        text = text_of(json.loads((results / "tradeoff.json").read_text(encoding="utf-8")))
        if not arguments.readme:
            print(text, end="")
            return
        for name in PLOTS:
            shutil.copyfile(results / f"{name}.svg", HERE / f"tradeoff_{name}.svg")
    path = pathlib.Path(arguments.readme)
    head, rest = path.read_text(encoding="utf-8").split("<!-- tradeoff -->\n", 1)
    tail = rest.split("<!-- /tradeoff -->", 1)[1]
    path.write_text(f"{head}<!-- tradeoff -->\n{text}<!-- /tradeoff -->{tail}", encoding="utf-8")


if __name__ == "__main__":
    main()
