"""Writes FORMATS.md: sweep.py READ_IMAGES [VERSIONS]

For each format, how many files of the sweep gscl reads as they say and how many it refuses, and with how many of them
independent readers agree."""

import collections
import os
import pathlib
import sys
import tempfile

import readers
from all_samples import all_samples
from picture import difference

HERE = pathlib.Path(__file__).resolve().parent
INDEPENDENT = {
    "Pillow": readers.pillow,
    "ImageMagick": readers.magick,
    "OpenCV": readers.opencv,
    "tifffile": readers.tifffile,
    "imagecodecs": readers.imagecodecs,
    "OpenEXR": readers.openexr,
}


def agreeing(sample, path):
    """The independent readers that see what the file is meant to show."""
    found = []
    for name, reader in INDEPENDENT.items():
        try:
            samples = reader(path)
        except Exception:  # of any library, about any variant that it does not know
            continue
        if samples is not None and difference(samples, sample.expected) <= sample.tolerance + 0.5 / 255:
            found.append(name)
    return found


def main():
    samples = [(sample, refused) for sample, refused in all_samples() if sample.format != "colours"]
    rows = collections.defaultdict(collections.Counter)
    refused, wrong = collections.defaultdict(list), []
    with tempfile.TemporaryDirectory() as folder:
        paths = []
        for number, (sample, _) in enumerate(samples):
            paths.append(os.path.join(folder, f"{number}{sample.suffix}"))
            pathlib.Path(paths[-1]).write_bytes(sample.data)
        for (sample, _), path, (got, message) in zip(samples, paths, readers.gscl(sys.argv[1], paths)):
            row = rows[sample.format]
            row["files"] += 1
            row[f"by {sample.writer}"] += 1
            if got is None:
                row["refused"] += 1
                refused[sample.format].append(f"{sample.variant} ({sample.writer})")
                continue
            if sample.expected is None or difference(got, sample.expected) > sample.tolerance + 1e-6:
                wrong.append(f"{sample.format}, {sample.variant} ({sample.writer})")
                continue
            row["right"] += 1
            row[f"confirmed by {min(2, len(agreeing(sample, path)))}"] += 1
    print_table(rows, refused, wrong)


def print_table(rows, refused, wrong):
    lines = [
        "# Image files that gscl reads",
        "",
        "Made by `tests/formats/sweep.py`, which writes files of each format in all their variants, by hand and with several",
        'libraries.  "Right" is within 1 of 255 of what the writer was given, beyond the loss of the format; what is not right is',
        'refused with a message.  "Two", "one", "none": how many of the right files are seen so by at least two, by one, or by none',
        "of " + ", ".join(INDEPENDENT) + ", none of which is a part of gscl's reader.",
        "",
        "| format | files | writers | right | refused | two | one | none |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for name, row in rows.items():
        if row["right"] == 0:
            continue
        writers = ", ".join(key[3:] for key in row if key.startswith("by "))
        lines.append(
            f"| {name} | {row['files']} | {writers} | {row['right']} | {row['refused']} | {row['confirmed by 2']} | "
            f"{row['confirmed by 1']} | {row['confirmed by 0']} |"
        )
    lines += ["", "Refused:", ""]
    lines += [f"- {name}: {'; '.join(variants)}" for name, variants in refused.items() if rows[name]["right"]]
    lines += [
        "",
        "Not read at all: " + ", ".join(sorted(name for name, row in rows.items() if row["right"] == 0)) + ".",
    ]
    lines += ["", "WRONG: " + "; ".join(wrong)] if wrong else []
    (HERE / "FORMATS.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
