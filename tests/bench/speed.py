#!/usr/bin/env python3
"""How fast gscl is on this machine, and how its time and memory grow, as Markdown tables.

    sh tests/bench/bench.sh speed FOLDER [--gscl build/gscl] [--readme README.md]

Kernels, stages and decoding in a program come from `gscl bench`; the rest are whole processes.  With --readme the
tables replace those between the marks <!-- speed --> and <!-- /speed --> of that file.  Wants a quiet machine.
"""
import datetime
import json
import os
import pathlib
import subprocess
import tempfile
import time

from PIL import Image

import codec

RATES = ("0.042", "0.183")
GROWTH_RATE = "0.1"
MOSAICS = (1, 2, 4, 8)  # pictures along each side
CORES = len(os.sched_getaffinity(0))


class Run:
    """A process: wall and CPU seconds, and its largest memory in MiB."""

    def __init__(self, *words, env=None):
        start = time.perf_counter()
        process = subprocess.Popen([str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   env={**os.environ, **(env or {})})
        self.output = process.stdout.read()
        errors = process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        self.wall_s = time.perf_counter() - start
        self.cpu_s = usage.ru_utime + usage.ru_stime
        self.memory_mib = usage.ru_maxrss / 1024
        if status:
            raise SystemExit(f"{' '.join(map(str, words))}: {errors.decode(errors='replace').strip()}")


def processor():
    for line in pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return "unknown processor"


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def kernel_tables(report):
    for mapping in report["kernels"]:
        measured = mapping["measurements"]
        device = {row["name"]: row["work_per_s"] * 1e-9 for row in measured if "blend" not in row}
        yield (f"`--mapping {mapping['mapping']}`: multiply-adds at {device['multiply_add']:.0f} Gflop/s, "
               f"copies at {device['copy']:.0f} GB/s.\n")
        rows = []
        for blend in ("normalized", "alpha", "sum"):
            for splats in (500, 2500):
                some = {row["name"]: row for row in measured if (row.get("blend"), row.get("splats")) == (blend, splats)}
                draw, step = some["raster_forward"], some["fit step"]
                rows.append([blend, str(splats)] +
                            [f"{row['work_per_s'] * 1e-9:.2f} ({100 * row['share_of_peak']:.0f} %)" for row in (draw, step)] +
                            [f"{1e3 * some[name]['median_s']:.2f}" for name in (
                                "bin", "fit_tiles", "gather_gradients", "adam_step")] +
                            [f"{draw['work_per_needed']:.2f}"])
        yield table(["blend", "splats", "draw, Geval/s", "fit step, Geval/s", "bin ms", "fit_tiles ms", "gather ms",
                     "adam ms", "evals per pixel inside"], rows)


def stage_tables(report):
    for what in ("encode", "decode"):
        pictures = [picture for picture in report["pictures"] if picture["what"] == what]
        names = list(dict.fromkeys(stage["name"] for picture in pictures for stage in picture["stages"]))
        rows = []
        for name in names:
            row = [name]
            for picture in pictures:
                stage = next((stage for stage in picture["stages"] if stage["name"] == name), None)
                row += [f"{1e3 * stage['seconds']:.2f}", f"{1e3 * (stage['seconds'] - stage['kernel_seconds']):.2f}"] if stage else ["", ""]
            rows.append(row)
        rows.append(["**all**"] + [text for picture in pictures for text in (f"**{1e3 * picture['median_s']:.1f}**", "")])
        yield table([f"{what} stage"] + [text for picture in pictures
                                         for text in (f"ms at {picture['bpp']} bpp", "outside kernels")], rows)


def process_table(gscl, images, work):
    rows = []
    for rate in RATES:
        encodes, decodes = [], []
        for image in images:
            coded = work / f"{image.stem}.gscl"
            encodes.append(Run(gscl, "encode", image, "-o", coded, "--bpp", rate, "-q"))
            Run(gscl, "decode", coded, "-o", work / "shown.png")
            decodes.append(Run(gscl, "decode", coded, "-o", work / "shown.png"))
        with tempfile.TemporaryDirectory() as cache:
            cold = Run(gscl, "decode", coded, "-o", work / "shown.png", env={"POCL_CACHE_DIR": cache})
        mean = lambda runs, key: sum(getattr(run, key) for run in runs) / len(runs)
        rows.append([rate, f"{mean(encodes, 'wall_s'):.2f}", f"{mean(encodes, 'cpu_s') / mean(encodes, 'wall_s'):.2f}",
                     f"{mean(decodes, 'wall_s'):.3f}", f"{cold.wall_s:.2f}"])
    return table(["bits per pixel", "encode s", f"of {CORES} cores", "decode s", "decode s, kernels not yet built"], rows)


def mosaic(images, side, path):
    """`side` x `side` of the pictures, so that every size has the same content."""
    whole = Image.new("RGB", (768 * side, 512 * side))
    for i in range(side * side):
        picture = Image.open(images[(i * 5 + i // side) % len(images)])
        if picture.width < picture.height:
            picture = picture.transpose(Image.Transpose.ROTATE_90)
        whole.paste(picture.resize((768, 512)), (i % side * 768, i // side * 512))
    whole.save(path, compress_level=1)
    return whole.width * whole.height * 1e-6


def growth_table(gscl, images, work):
    rows = []
    for side in MOSAICS:
        path, coded = work / "mosaic.png", work / "mosaic.gscl"
        runs = []
        for first in range(len(images) if side == 1 else 1):  # one picture says little about the mean
            pixels = mosaic(images[first:], side, path)
            encode = Run(gscl, "encode", path, "-o", coded, "--bpp", GROWTH_RATE, "-q")
            runs.append((encode, Run(gscl, "decode", coded, "-o", work / "shown.png")))
        encode_s, decode_s = (sum(run[i].wall_s for run in runs) / len(runs) for i in (0, 1))
        rows.append([f"{pixels:.1f}", f"{encode_s:.2f}", f"{encode_s / pixels:.2f}", f"{runs[0][0].memory_mib:.0f}",
                     f"{decode_s:.2f}", f"{decode_s / pixels:.3f}", f"{runs[0][1].memory_mib:.0f}"])
    return table(["megapixels", "encode s", "per megapixel", "MiB", "decode s", "per megapixel", "MiB"], rows)


def batch_line(gscl, images, work):
    many = [images[i % len(images)] for i in range(48)]
    copies = []
    for i, image in enumerate(many):
        copies.append(work / f"copy{i}.png")
        copies[-1].write_bytes(image.read_bytes())
    options = ("-q", "--bpp", RATES[0])
    single = sum(Run(gscl, "encode", copy, *options).wall_s for copy in copies)
    batch = Run(gscl, "encode", *copies, *options)
    return (f"48 pictures at {RATES[0]} bits a pixel: {batch.wall_s:.1f} s in one call, with {batch.cpu_s / batch.wall_s:.2f} "
            f"of {CORES} cores busy; {single:.1f} s in 48 calls.\n")


def report_of(arguments, work):
    images = codec.images_of(arguments.folder, arguments.only)
    bench = json.loads(Run(arguments.gscl, "bench", images[0], "--json").output)
    parts = [f"{datetime.date.today()}, {processor()}, {CORES} cores; {bench['device']}, {bench['version']}; "
             f"`sh tests/bench/bench.sh speed FOLDER`, {len(images)} pictures.\n"]
    parts += ["Whole processes, means:\n", process_table(arguments.gscl, images, work), batch_line(arguments.gscl, images, work)]
    parts += [f"Growth, at {GROWTH_RATE} bits a pixel:\n", growth_table(arguments.gscl, images, work)]
    parts += [f"Where the time goes, {images[0].stem}:\n", *stage_tables(bench)]
    parts += ["Kernels, 768x512; share of the multiply-add peak at 28 operations an evaluation forward, 100 in a step:\n",
              *kernel_tables(bench)]
    return "\n".join(parts)


def put_into(readme, text):
    path = pathlib.Path(readme)
    head, rest = path.read_text(encoding="utf-8").split("<!-- speed -->\n", 1)
    tail = rest.split("<!-- /speed -->", 1)[1]
    path.write_text(f"{head}<!-- speed -->\n{text}<!-- /speed -->{tail}", encoding="utf-8")


def main():
    parser = codec.parser(__doc__)
    parser.add_argument("--readme", help="file whose tables are to be replaced")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        text = report_of(arguments, pathlib.Path(folder))
    if arguments.readme:
        put_into(arguments.readme, text)
    print(text, end="")


if __name__ == "__main__":
    main()
