#!/usr/bin/env python3
"""Effects that the encoder chooses for images of many kinds, compared with fixed choices at the same file size.

    sh tests/bench/bench.sh effects [FOLDER] [--gscl build/gscl] [--bpp 0.125] [--seeds 4] [--document [EFFECTS.md]]

FOLDER holds PNG images.  Without it two sets are measured: the images of scenes.py, on which the encoder's thresholds
were found, and those of scenes_held_out.py, on which none was tuned.  The PSNR of one image varies with the seed by 0.1 to
1 dB, which is more than the gain of many effects, so that means over seeds are compared.  All encodes have --tune psnr.  Prints
a Markdown table for each set, and with --document writes them into the sections `effects` and `effects-held-out` of that document.
"""
import argparse
import pathlib
import statistics
import tempfile

import codec
import document
import scenes
import scenes_held_out

SETS = {"effects": scenes, "effects-held-out": scenes_held_out}  # section of the document: the script that draws the set
ELLIPSES = "+rotation,+anisotropy"
CIRCLES = "-rotation,-anisotropy"
FIXED = {
    "all on": f"{ELLIPSES},+texture,+opacity",
    "ellipses": f"{ELLIPSES},-texture,-opacity",
    "ellipses, texture": f"{ELLIPSES},+texture,-opacity",
    "circles": f"{CIRCLES},-texture,-opacity",
    "circles, texture": f"{CIRCLES},+texture,-opacity",
    "circles, texture, opacity": f"{CIRCLES},+texture,+opacity",
    "ellipses, texture, grey": f"{ELLIPSES},+texture,-opacity,-chroma",
}


def encode(arguments, image, effects, seed, work):
    """Encodes once; returns the report."""
    options = ["--effects", effects] if effects else []
    report = codec.run(arguments.gscl, "encode", image, "-o", work / "coded.gscl", "--bpp", arguments.bpp, "--quiet", "--json",
                       *codec.TUNE_PSNR, "--seed", seed, *options)[1]
    report["psnr"] = 99.0 if report["psnr"] is None else report["psnr"]
    return report


def mean(reports, key):
    return statistics.mean(report[key] for report in reports)


def describe(reports):
    """The decision on each effect: the number of files that use it, and its mean gain in probe fits."""
    called, refused = [], []
    for decision in reports[0]["effects"]:
        name = decision["name"]
        gains = [d["gain_db"] for r in reports for d in r["effects"] if d["name"] == name and d["gain_db"] is not None]
        tried = f" ({statistics.mean(gains):+.1f} dB)" if gains else ""
        used = sum(name in report["used"] for report in reports)
        if used:
            called.append(name + (f" {used}/{len(reports)}" if used < len(reports) else "") + tried)
        elif gains:
            refused.append(name + tried)
    return (", ".join(called) or "none") + ("; not " + ", ".join(refused) if refused else "")


def row_of(arguments, image, work):
    choices = {"auto": "", **FIXED}
    reports = {name: [] for name in choices}
    for seed in range(1, arguments.seeds + 1):  # choices alternate, so that changes of the load affect all of them
        for name, effects in choices.items():
            reports[name].append(encode(arguments, image, effects, seed, work))
            if name == "auto":
                reports[name][-1]["used"] = codec.run(arguments.gscl, "info", work / "coded.gscl", "--json")[1]["effects"]
    seconds = {name: statistics.median(report["seconds"] for report in reports[name]) for name in ("auto", "all on")}
    best = max(FIXED, key=lambda name: mean(reports[name], "psnr"))
    psnrs = [report["psnr"] for report in reports["auto"]]
    return dict(name=image.stem, text=describe(reports["auto"]), psnr=mean(reports["auto"], "psnr"),
                spread=statistics.stdev(psnrs) if len(psnrs) > 1 else 0.0, seconds=seconds["auto"],
                all_psnr=mean(reports["all on"], "psnr"), all_seconds=seconds["all on"], best=best, best_psnr=mean(reports[best], "psnr"))


def table_of(rows, arguments, source):
    yield (f"{source}, {arguments.bpp} bits per pixel, means of {arguments.seeds} seeds (and their standard deviation);"
           " `sh tests/bench/bench.sh effects`:\n")
    yield "| image | effects chosen (gain in probe fits) | auto dB | s | all on dB | s | best fixed choice | dB | auto less best |"
    yield "|---|---|---|---|---|---|---|---|---|"
    for r in rows:
        yield (f"| {r['name']} | {r['text']} | {r['psnr']:.2f} ({r['spread']:.2f}) | {r['seconds']:.2f} | {r['all_psnr']:.2f} |"
               f" {r['all_seconds']:.2f} | {r['best']} | {r['best_psnr']:.2f} | {r['psnr'] - r['best_psnr']:+.2f} |")
    ratio = statistics.geometric_mean(max(r["seconds"], 1e-3) / max(r["all_seconds"], 1e-3) for r in rows)
    loss = statistics.mean(r["psnr"] - r["best_psnr"] for r in rows)
    yield f"\nAuto less best: {loss:+.2f} dB (mean). Time of auto against all on: {ratio:.2f} (geometric mean)."


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", help="folder of PNG images (default: both sets of scenes)")
    parser.add_argument("--gscl", default="build/gscl")
    parser.add_argument("--bpp", type=float, default=0.125)
    parser.add_argument("--seeds", type=int, default=4, help="encodes of each choice (default %(default)s)")
    document.add_option(parser, "EFFECTS.md", "effects")
    arguments = parser.parse_args()
    names = [arguments.section] if arguments.folder else list(SETS)
    sections = {name: document.Section(arguments.document, name) if arguments.document else None for name in names}
    with tempfile.TemporaryDirectory() as work:
        work = pathlib.Path(work)
        for name, section in sections.items():
            folder, source = arguments.folder, f"Images of `{arguments.folder}`"
            if not folder:
                folder, source = work / name, f"Images of `tests/bench/{SETS[name].__name__}.py`"
                SETS[name].draw_all(folder)
            rows = [row_of(arguments, image, work) for image in codec.images_of(folder)]
            document.publish(section, "\n".join(table_of(rows, arguments, source)) + "\n")


if __name__ == "__main__":
    main()
