#!/usr/bin/env python3
"""Quality against rate of gscl beside JPEG, JPEG 2000, JPEG XL, WebP, AVIF and VVC on a folder of PNG images: a plot and tables.

    sh tests/bench/bench.sh compare_codecs FOLDER [--gscl build/gscl] [--codecs NAME,NAME] [--plot FILE.svg]
                                           [--csv FILE] [--points FILE.csv] [--jobs 2] [--document [RESULTS.md]]

gscl has --tune psnr where no other tune is named.  The other codecs are those of Pillow: libjpeg-turbo (4:2:0, optimised),
OpenJPEG (9/7 wavelet, colour transform), libjxl of pillow-jxl-plugin (effort 7), libwebp (method 6) and libavif (speed 4, tuned
for PSNR); and those of ffmpeg in imageio-ffmpeg: libaom at speed 0 with 10 bits, and vvenc (preset medium, 10 bits, 4:2:0, without
a container).  Each image is coded at many qualities; between two of them the quality is interpolated linearly in the logarithm of
the rate.  A curve is the mean over all images, and is drawn where every image reaches the rate.  --csv writes every measured point;
--points adds points from such a file, or from one with the columns image, bpp, psnr and optionally msssim and codec (default: the
paper).  Marks are means over 24 Kodak images that others have published: published.csv.
"""
import collections
import concurrent.futures
import csv
import itertools
import math
import pathlib
import subprocess
import tempfile

import imageio_ffmpeg
import pillow_jxl  # noqa: F401 (adds JPEG XL to Pillow)
from PIL import Image

import codec
import document
import plots

PSNR, MS_SSIM = 3, 4  # columns of the measured rows
PUBLISHED = pathlib.Path(__file__).parent / "published.csv"
# Bits per pixel.
RATES = (0.03, 0.042, 0.066, 0.1, 0.125, 0.183, 0.3, 0.5, 1.0)
TABLE_RATES = (0.042, 0.066, 0.125, 0.183, 0.3, 0.5, 1.0)
VARIANTS = {"gscl": codec.TUNE_PSNR, "gscl --tune ssim": ("--tune", "ssim")}
# By codec: suffix, quality option of Pillow, its values, and further options.
OTHERS = {
    "JPEG": (".jpg", "quality", (1, 2, 3, 5, 8, 12, 17, 24, 33, 45, 58, 72, 84, 92), dict(optimize=True, subsampling="4:2:0")),
    "JPEG 2000": (".jp2", "quality_layers", tuple([24 / rate] for rate in (0.025, 0.035, 0.05, 0.07, 0.1, 0.14, 0.2, 0.3, 0.45, 0.7, 1.1)),
                  dict(irreversible=True, mct=1, quality_mode="rates")),
    "JPEG XL": (".jxl", "quality", (0, 2, 5, 9, 14, 20, 27, 35, 45, 56, 68, 80), dict(effort=7)),
    "WebP": (".webp", "quality", (0, 1, 3, 6, 10, 16, 25, 36, 50, 65, 78, 88), dict(method=6)),
    "AVIF": (".avif", "quality", (0, 2, 5, 9, 14, 20, 27, 35, 44, 54, 64, 74), dict(speed=4, advanced={"tune": "psnr"})),
}
# By codec: suffix, quality option of ffmpeg, its values, and further options.
FFMPEG = {
    "AVIF speed 0": (".avif", "-crf", (63, 62, 60, 57, 53, 48, 43, 38, 32, 26),
                      ("-c:v", "libaom-av1", "-still-picture", 1, "-cpu-used", 0, "-b:v", 0, "-aom-params", "tune=psnr")),
    "VVC": (".vvc", "-qp", (63, 60, 57, 54, 51, 48, 45, 42, 38, 34, 30), ("-c:v", "libvvenc", "-preset", "medium", "-f", "vvc")),
}
COLOURS = {"gscl": "tab:red", "gscl --tune ssim": "tab:orange", "JPEG": "tab:gray", "JPEG 2000": "tab:blue", "JPEG XL": "tab:cyan",
           "WebP": "tab:green", "AVIF": "tab:purple", "AVIF speed 0": "violet", "VVC": "tab:brown", "the paper": "black"}


def measure_gscl(gscl, name, image, rate):
    with tempfile.TemporaryDirectory() as folder:
        row = codec.measure(gscl, image, rate, VARIANTS[name], pathlib.Path(folder))
    return name, image.stem, row["bpp"], row["psnr"], row["ms_ssim"]


def row_of(gscl, name, image, coded, decoded):
    """The row of a file, and of what its decoder made of it."""
    with Image.open(image) as source:
        pixels = source.width * source.height
    quality = codec.compare(gscl, image, decoded)
    return name, image.stem, 8 * coded.stat().st_size / pixels, quality["psnr"], quality["ms_ssim"]


def measure_other(gscl, name, image, value):
    suffix, option, _, fixed_options = OTHERS[name]
    with tempfile.TemporaryDirectory() as folder:
        coded, decoded = pathlib.Path(folder, "coded" + suffix), pathlib.Path(folder, "decoded.png")
        with Image.open(image) as source:
            source.convert("RGB").save(coded, **{option: value}, **fixed_options)
        with Image.open(coded) as opened:
            opened.convert("RGB").save(decoded)
        return row_of(gscl, name, image, coded, decoded)


def run_ffmpeg(*words):
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-hide_banner", "-loglevel", "error", "-y", *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{' '.join(command)}: {done.stderr.strip()}")


def measure_ffmpeg(gscl, name, image, value):
    suffix, option, _, fixed_options = FFMPEG[name]
    with tempfile.TemporaryDirectory() as folder:
        coded, decoded = pathlib.Path(folder, "coded" + suffix), pathlib.Path(folder, "decoded.png")
        run_ffmpeg("-i", image, "-pix_fmt", "yuv420p10le", option, value, *fixed_options, coded)
        run_ffmpeg("-i", coded, "-frames:v", 1, "-pix_fmt", "rgb24", decoded)
        return row_of(gscl, name, image, coded, decoded)


def measure_all(arguments, images):
    """Rows (codec, image, bpp, psnr, ms_ssim)."""
    chosen = arguments.codecs.split(",") if arguments.codecs else [*VARIANTS, *OTHERS, *FFMPEG]
    others = [name for name in OTHERS if name in chosen]
    tasks = [(measure_other, name, image, value) for image in images for name in others for value in OTHERS[name][2]]
    tasks += [(measure_gscl, name, image, rate) for image in images for name in VARIANTS if name in chosen for rate in RATES]
    tasks += [(measure_ffmpeg, name, image, value) for image in images for name in FFMPEG if name in chosen for value in FFMPEG[name][2]]
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        return list(pool.map(lambda task: task[0](arguments.gscl, *task[1:]), tasks))


def read_points(path):
    with open(path, newline="", encoding="utf-8") as file:
        return [(row.get("codec", "the paper"), row["image"], float(row["bpp"]), float(row["psnr"]),
                 float(row.get("msssim") or "nan")) for row in csv.DictReader(file)]


def curves_of(rows, name, column):
    """By image: sorted points (rate, quality) of one codec."""
    images = collections.defaultdict(dict)
    for row in rows:
        if row[0] == name and not math.isnan(row[column]):
            images[row[1]][row[2]] = row[column]
    return {image: sorted(points.items()) for image, points in images.items() if len(points) > 1}


def mean_curve(rows, name, column, rates):
    """[(rate, mean over all images)] where every image reaches the rate."""
    curves = curves_of(rows, name, column).values()
    curve = []
    for rate in rates:
        values = [codec.at_rate(points, rate) for points in curves]
        if values and None not in values:
            curve.append((rate, sum(values) / len(values)))
    return curve


def mark_published(axis, column):
    """Marks the means that others have published."""
    codecs = itertools.groupby(read_points(PUBLISHED), key=lambda row: row[0])
    for mark, (name, points) in zip(itertools.cycle("ovs^Dp*X"), codecs):
        places = [(row[2], row[column]) for row in points if not math.isnan(row[column])]
        if places:
            axis.plot(*zip(*places), label=name, linestyle="none", marker=mark, markersize=4, color="0.35")


def draw(rows, path):
    figure, axes = plots.pyplot.subplots(1, 2, figsize=(10.5, 4.3), constrained_layout=True)
    fine = [0.025 * 1.03 ** i for i in range(130)]
    names = list(dict.fromkeys(row[0] for row in rows))
    names.sort(key=lambda name: list(COLOURS).index(name) if name in COLOURS else len(COLOURS))
    for axis, column, title in ((axes[0], PSNR, "PSNR, dB"), (axes[1], MS_SSIM, "MS-SSIM")):
        for name in names:
            curve = [point for point in mean_curve(rows, name, column, fine) if point[0] <= 1.05]
            style = dict(color=COLOURS.get(name), linewidth=2.2 if name.startswith("gscl") else 1.3)
            if curve:
                axis.plot(*zip(*curve), label=name, **style)
        mark_published(axis, column)
        axis.set(xscale="log", xlabel="bits per pixel", title=title, xlim=(0.028, 1.05))
        axis.set_xticks((0.03, 0.05, 0.1, 0.2, 0.5, 1.0), ("0.03", "0.05", "0.1", "0.2", "0.5", "1"))
        axis.minorticks_off()
        axis.grid(True, alpha=0.3)
    axes[1].set_ylim(0.75, 1.0)
    axes[0].legend(loc="upper left", fontsize=6, ncols=2)
    plots.save(figure, path)


def mean_table(rows, column, title, digits):
    """Means of each codec at the rates that every image reaches."""
    body = []
    for name in COLOURS:
        means = dict(mean_curve(rows, name, column, TABLE_RATES))
        if means:
            body.append([name, *(f"{means[rate]:.{digits}f}" if rate in means else "-" for rate in TABLE_RATES)])
    return document.table([title, *(f"{rate:g}" for rate in TABLE_RATES)], body)


def difference_cell(ours, theirs, rate):
    """Mean difference in PSNR over the images whose both curves reach the rate, and how many of them are won."""
    pairs = [(codec.at_rate(ours[image], rate), codec.at_rate(theirs[image], rate)) for image in ours.keys() & theirs.keys()]
    differences = [a - b for a, b in pairs if a is not None and b is not None]
    if not differences:
        return "-"
    return f"{sum(differences) / len(differences):+.2f} ({sum(d > 0 for d in differences)} of {len(differences)})"


def difference_table(rows):
    """Differences of gscl in PSNR to each other codec at the same rate."""
    ours = curves_of(rows, "gscl", PSNR)
    curves = {name: curves_of(rows, name, PSNR) for name in COLOURS if name not in VARIANTS}
    curves = {name: theirs for name, theirs in curves.items() if theirs}
    return document.table(["gscl, dB (images won)", *(f"against {name}" for name in curves)],
                          [[f"{rate:g}", *(difference_cell(ours, theirs, rate) for theirs in curves.values())]
                           for rate in TABLE_RATES])


def write_csv(path, rows):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(("codec", "image", "bpp", "psnr", "msssim"))
        writer.writerows(rows)


def main():
    parser = codec.parser(__doc__)
    parser.add_argument("--codecs", default="", help="codecs to measure, separated by commas (default: " +
                        ", ".join([*VARIANTS, *OTHERS, *FFMPEG]) + ")")
    parser.add_argument("--plot", help="plot to write (default: quality.svg, beside the document if one is given)")
    parser.add_argument("--points", action="append", default=[], help="CSV file of points measured before or elsewhere")
    parser.add_argument("--jobs", type=int, default=2, help="encodes at a time (default %(default)s)")
    parser.add_argument("--csv", help="file for every measured point: codec, image, bpp, psnr, msssim")
    document.add_option(parser, "RESULTS.md", "other-codecs")
    arguments = parser.parse_args()
    section = document.section_of(arguments)
    images = codec.images_of(arguments.folder, arguments.only)
    rows = measure_all(arguments, images)
    if arguments.csv:
        write_csv(arguments.csv, rows)
    for path in arguments.points:
        rows += read_points(path)
    draw(rows, arguments.plot or (section.path.parent if section else pathlib.Path()) / "quality.svg")
    document.publish(section, document.origin("sh tests/bench/bench.sh compare_codecs FOLDER", len(images)),
                     mean_table(rows, PSNR, "PSNR dB", 2), mean_table(rows, MS_SSIM, "MS-SSIM", 3), difference_table(rows))


if __name__ == "__main__":
    main()
