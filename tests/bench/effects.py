#!/usr/bin/env python3
"""Which effects pictures of many kinds call for: what the encoder decides by itself against fixed choices, at the same size.

    sh tests/bench/bench.sh effects [FOLDER] [--gscl build/gscl] [--bpp 0.125] [--readme README.md]

FOLDER holds PNG images; without it, the pictures that scenes.py draws.  Prints Markdown tables, or puts them between
README's `<!-- effects -->` marks.
"""
import argparse
import pathlib
import re
import statistics
import tempfile

import codec
import scenes

ELLIPSES = "+rotation,+anisotropy"
CIRCLES = "-rotation,-anisotropy"
FIXED = {
    "all on": f"{ELLIPSES},+texture,+opacity",
    "ellipses": f"{ELLIPSES},-texture,-opacity",
    "ellipses, texture": f"{ELLIPSES},+texture,-opacity",
    "circles": f"{CIRCLES},-texture,-opacity",
    "circles, texture": f"{CIRCLES},+texture,-opacity",
    "ellipses, texture, grey": f"{ELLIPSES},+texture,-opacity,-chroma",
}


def encode(arguments, image, effects, work):
    """Returns (PSNR, seconds, decisions) of an encode."""
    options = ["--effects", effects] if effects else []
    runs = [codec.run(arguments.gscl, "encode", image, "-o", work / "picture.gscl", "--bpp", arguments.bpp, "-q", "--json",
                      *options)[1] for _ in range(arguments.rounds)]
    psnr = runs[0]["psnr"]
    return 99.0 if psnr is None else psnr, min(run["seconds"] for run in runs), runs[0]["effects"]


def row_of(arguments, image, work):
    fixed = {name: encode(arguments, image, effects, work) for name, effects in FIXED.items()}
    psnr, seconds, decisions = encode(arguments, image, "", work)
    best = max(fixed, key=lambda name: fixed[name][0])
    on = [d["name"] + (f" ({d['gain_db']:+.1f} dB)" if d["gain_db"] is not None else "") for d in decisions if d["on"]]
    off = [f"{d['name']} ({d['gain_db']:+.1f} dB)" for d in decisions if not d["on"] and d["gain_db"] is not None]
    uses = codec.run(arguments.gscl, "info", work / "picture.gscl", "--json")[1]
    used = [name for name in on if name.split(" ")[0] in uses["effects"]]
    text = ", ".join(used) or "none"
    if off:
        text += "; not " + ", ".join(off)
    return dict(name=image.stem, text=text, psnr=psnr, seconds=seconds, all_psnr=fixed["all on"][0],
                all_seconds=fixed["all on"][1], best=best, best_psnr=fixed[best][0])


def table_of(rows, arguments):
    yield f"Pictures drawn by `tests/bench/scenes.py`, {arguments.bpp} bits a pixel; `sh tests/bench/bench.sh effects`:\n"
    yield "| picture | effects called for (tried gain) | auto dB | s | all on dB | s | best fixed choice | dB | auto less best |"
    yield "|---|---|---|---|---|---|---|---|---|"
    for r in rows:
        yield (f"| {r['name']} | {r['text']} | {r['psnr']:.2f} | {r['seconds']:.2f} | {r['all_psnr']:.2f} | {r['all_seconds']:.2f}"
               f" | {r['best']} | {r['best_psnr']:.2f} | {r['psnr'] - r['best_psnr']:+.2f} |")
    ratio = statistics.geometric_mean(r["seconds"] / r["all_seconds"] for r in rows)
    yield f"\nTime of auto against all on: {ratio:.2f} (geometric mean)."


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", help="of PNG images (default: those of scenes.py)")
    parser.add_argument("--gscl", default="build/gscl")
    parser.add_argument("--bpp", type=float, default=0.125)
    parser.add_argument("--rounds", type=int, default=3, help="encodes, of which the fastest counts (default %(default)s)")
    parser.add_argument("--readme", help="file in which to replace the tables")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as work:
        work = pathlib.Path(work)
        folder = arguments.folder or work / "scenes"
        if not arguments.folder:
            scenes.draw_all(folder)
        rows = [row_of(arguments, image, work) for image in codec.images_of(folder)]
    text = "\n".join(table_of(rows, arguments))
    if not arguments.readme:
        print(text)
        return
    path = pathlib.Path(arguments.readme)
    marked = re.sub(r"(?s)(<!-- effects -->\n).*?(<!-- /effects -->)", lambda m: m[1] + text + "\n" + m[2], path.read_text())
    path.write_text(marked)


if __name__ == "__main__":
    main()
