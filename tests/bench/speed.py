#!/usr/bin/env python3
"""The speed of gscl on this machine, and the growth of its time and memory with the size of the image, as Markdown tables.

    sh tests/bench/bench.sh speed FOLDER [--gscl build/gscl] [--only NAME,NAME] [--document [SPEED.md]]

Kernels, stages and the codec within one process come from `gscl bench`; the other figures are those of whole processes.
All encodes have --tune psnr.  With --document the tables replace the section `speed` of that document.  The machine should have
no other load.
"""
import json
import pathlib
import tempfile

from PIL import Image

import codec
import document
from document import CORES, table
from process import Run

RATES = ("0.042", "0.183")  # bits per pixel
GROWTH_RATE = "0.1"
MOSAIC_SIDES = (1, 2, 4, 8)  # images along each side
MOSAIC_CELL = (768, 512)  # pixels
BATCH_SIZE = 48  # images


def mean(runs, attribute):
    return sum(getattr(run, attribute) for run in runs) / len(runs)


# ---- Inside one process: gscl bench ----------------------------------------------------------------

def kernel_row(measurements, blend, splats):
    rows = {row["name"]: row for row in measurements if (row.get("blend"), row.get("splats")) == (blend, splats)}
    rates = [f"{rows[name]['work_per_s'] * 1e-9:.2f} ({100 * rows[name]['share_of_peak']:.0f} %)"
             for name in ("raster_forward", "fit step")]
    times = [f"{1e3 * rows[name]['median_s']:.2f}" for name in ("bin", "fit_tiles", "step_splats")]
    return [blend, str(splats), *rates, *times, f"{rows['raster_forward']['work_per_needed']:.2f}"]


def kernel_tables(report):
    for mapping in report["kernels"]:
        measurements = mapping["measurements"]
        device = {row["name"]: row["work_per_s"] * 1e-9 for row in measurements if "blend" not in row}
        yield (f"`--mapping {mapping['mapping']}`: multiply-adds at {device['multiply_add']:.0f} Gflop/s, "
               f"copies at {device['copy']:.0f} GB/s.\n")
        yield table(["blend", "splats", "draw, Geval/s", "fit step, Geval/s", "bin ms", "fit_tiles ms", "step_splats ms",
                     "evals per pixel inside"],
                    [kernel_row(measurements, blend, splats) for blend in ("normalized", "alpha", "sum")
                     for splats in (500, 2500)])


def runs_of(report, operation):
    return [run for run in report["codec"] if run["operation"] == operation]


def named_rows(runs, key, cells_of, width):
    """A row for each name in the lists run[key], with `width` cells of each run: empty where a run lacks the name."""
    lists = [{row["name"]: row for row in run[key]} for run in runs]
    names = dict.fromkeys(name for rows in lists for name in rows)
    return [[name, *(cell for rows in lists for cell in (cells_of(rows[name]) if name in rows else [""] * width))]
            for name in names]


def stage_cells(stage):
    return [f"{1e3 * stage['seconds']:.2f}", f"{1e3 * (stage['seconds'] - stage['kernel_seconds']):.2f}"]


def stage_table(report, operation):
    runs = runs_of(report, operation)
    head = [f"{operation} stage", *(text for run in runs for text in (f"ms at {run['bpp']} bpp", "outside kernels"))]
    rows = named_rows(runs, "stages", stage_cells, 2)
    total = ["**all**", *(text for run in runs for text in (f"**{1e3 * run['median_s']:.1f}**", ""))]
    return table(head, [*rows, total])


def counts_line(report):
    counts = [f"{run['launches']} launches and {run['waits']} waits at {run['bpp']} bpp" for run in runs_of(report, "encode")]
    return f"Launches of kernels by an encode, and its waits for the device: {', '.join(counts)}.\n"


def items_cells(kernel):
    return [str(kernel["count"]), f"{kernel['mean_items']:.0f}", str(kernel["fewest_items"])]


def items_table(report):
    """The work-items of each kernel of an encode: means over its launches, and the fewest of any."""
    runs = runs_of(report, "encode")
    head = ["kernel", *(text for run in runs for text in (f"launches at {run['bpp']} bpp", "mean items", "fewest"))]
    return table(head, named_rows(runs, "kernels", items_cells, 3))


# ---- Whole processes -------------------------------------------------------------------------------

def process_row(gscl, images, rate, work):
    encodes, decodes = [], []
    for image in images:
        coded = work / f"{image.stem}.gscl"
        encodes.append(Run(gscl, "encode", image, "-o", coded, "--bpp", rate, *codec.TUNE_PSNR, "--quiet"))
        Run(gscl, "decode", coded, "-o", work / "decoded.png")
        decodes.append(Run(gscl, "decode", coded, "-o", work / "decoded.png"))
    with tempfile.TemporaryDirectory() as cache:
        empty = {"POCL_CACHE_DIR": cache, "XDG_CACHE_HOME": cache}
        cold = Run(gscl, "encode", images[0], "-o", coded, "--bpp", rate, *codec.TUNE_PSNR, "--quiet", env=empty)
    return [rate, f"{mean(encodes, 'wall_s'):.2f}", f"{mean(encodes, 'cpu_s') / mean(encodes, 'wall_s'):.2f}",
            f"{cold.wall_s:.2f}", f"{mean(decodes, 'wall_s'):.3f}"]


def process_table(gscl, images, work):
    return table(["bits per pixel", "encode s", f"of {CORES} cores", "first, builds kernels", "decode s"],
                 [process_row(gscl, images, rate, work) for rate in RATES])


def write_mosaic(images, side, path):
    """Writes `side` x `side` of the images, so that all sizes have the same content.  Returns megapixels."""
    width, height = MOSAIC_CELL
    mosaic = Image.new("RGB", (width * side, height * side))
    for i in range(side * side):
        cell = Image.open(images[(i * 5 + i // side) % len(images)])
        if cell.width < cell.height:
            cell = cell.transpose(Image.Transpose.ROTATE_90)
        mosaic.paste(cell.resize(MOSAIC_CELL), (i % side * width, i // side * height))
    mosaic.save(path, compress_level=1)
    return mosaic.width * mosaic.height * 1e-6


def growth_row(gscl, images, side, work):
    path, coded = work / "mosaic.png", work / "mosaic.gscl"
    encodes, decodes = [], []
    for first in range(len(images) if side == 1 else 1):  # a mosaic is a mean over images; a single image is not
        megapixels = write_mosaic(images[first:], side, path)
        encodes.append(Run(gscl, "encode", path, "-o", coded, "--bpp", GROWTH_RATE, *codec.TUNE_PSNR, "--quiet"))
        decodes.append(Run(gscl, "decode", coded, "-o", work / "decoded.png"))
    encode_s, decode_s = mean(encodes, "wall_s"), mean(decodes, "wall_s")
    return [f"{megapixels:.1f}", f"{encode_s:.2f}", f"{encode_s / megapixels:.2f}", f"{encodes[0].memory_mib:.0f}",
            f"{decode_s:.2f}", f"{decode_s / megapixels:.3f}", f"{decodes[0].memory_mib:.0f}"]


def growth_table(gscl, images, work):
    return table(["megapixels", "encode s", "per megapixel", "MiB", "decode s", "per megapixel", "MiB"],
                 [growth_row(gscl, images, side, work) for side in MOSAIC_SIDES])


def batch_line(gscl, images, work):
    copies = [work / f"copy{i}.png" for i in range(BATCH_SIZE)]
    for i, copy in enumerate(copies):
        copy.write_bytes(images[i % len(images)].read_bytes())
    options = ("--quiet", "--bpp", RATES[0], *codec.TUNE_PSNR)
    single_s = sum(Run(gscl, "encode", copy, *options).wall_s for copy in copies)
    batch = Run(gscl, "encode", *copies, *options)
    return (f"{BATCH_SIZE} images at {RATES[0]} bits per pixel: {batch.wall_s:.1f} s in one call, with "
            f"{batch.cpu_s / batch.wall_s:.2f} of {CORES} cores busy; {single_s:.1f} s in {BATCH_SIZE} calls.\n")


def section_parts(arguments, work):
    images = codec.images_of(arguments.folder, arguments.only)
    bench = json.loads(Run(arguments.gscl, "bench", images[0], *codec.TUNE_PSNR, "--json").output)
    yield document.origin("sh tests/bench/bench.sh speed FOLDER", len(images))
    yield f"Device: {bench['device']}, {bench['version']}.\n"
    yield "Whole processes, means:\n"
    yield process_table(arguments.gscl, images, work)
    yield batch_line(arguments.gscl, images, work)
    yield f"Growth, at {GROWTH_RATE} bits per pixel:\n"
    yield growth_table(arguments.gscl, images, work)
    yield f"Time by stage, {images[0].stem}:\n"
    yield from (stage_table(bench, operation) for operation in ("encode", "decode"))
    yield counts_line(bench)
    yield f"Work-items of the kernels of an encode of {images[0].stem} in the mapping for GPUs:\n"
    for_gpus = Run(arguments.gscl, "bench", images[0], *codec.TUNE_PSNR, "--json", "--mapping", "gpu", "--encodes", 1,
                   "--repetitions", 1)
    yield items_table(json.loads(for_gpus.output))
    yield ("Kernels, 768x512; the share of the multiply-add peak counts 28 operations per evaluation when drawing "
           "and 100 in a fit step:\n")
    yield from kernel_tables(bench)


def main():
    parser = codec.parser(__doc__)
    document.add_option(parser, "SPEED.md", "speed")
    arguments = parser.parse_args()
    section = document.section_of(arguments)
    with tempfile.TemporaryDirectory() as folder:
        document.publish(section, *section_parts(arguments, pathlib.Path(folder)))


if __name__ == "__main__":
    main()
