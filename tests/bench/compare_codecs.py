#!/usr/bin/env python3
"""Quality against rate of gscl beside JPEG, JPEG 2000, WebP and AVIF on a folder of PNG images: a plot and a table.

    sh tests/bench/bench.sh compare_codecs FOLDER [--gscl build/gscl] [--plot FILE.svg] [--points FILE.csv] [--jobs 2]

The other codecs are those inside Pillow: libjpeg-turbo (4:2:0, optimised), OpenJPEG (9/7 wavelet, colour transform),
libwebp (method 6) and libavif (speed 4, tuned for PSNR).  Each picture is coded at many qualities; between two of them
quality is interpolated linearly in the logarithm of the rate.  A curve is the mean over all pictures, and is drawn
where every picture reaches the rate.  --points adds what was measured elsewhere or before (--csv): a file with the columns image, bpp, psnr, and if
known msssim and codec ("the paper" where there is none).
"""
import collections
import concurrent.futures
import csv
import math
import pathlib
import tempfile

import matplotlib
from PIL import Image

import codec

matplotlib.use("Agg")
matplotlib.rcParams["svg.fonttype"] = "none"  # text stays text
matplotlib.rcParams["svg.hashsalt"] = "gscl"  # same figures, same file
import matplotlib.pyplot as pyplot  # noqa: E402

RATES = (0.03, 0.042, 0.066, 0.1, 0.125, 0.183, 0.3, 0.5, 1.0)
TABLE_RATES = (0.042, 0.066, 0.125, 0.183, 0.3, 0.5, 1.0)
VARIANTS = {"gscl": (), "gscl --tune ssim": ("--tune", "ssim")}
# How Pillow writes each codec, and the values of its quality option.
OTHERS = {
    "JPEG": (".jpg", "quality", (1, 2, 3, 5, 8, 12, 17, 24, 33, 45, 58, 72, 84, 92), dict(optimize=True, subsampling="4:2:0")),
    "JPEG 2000": (".jp2", "quality_layers", tuple([24 / rate] for rate in (0.025, 0.035, 0.05, 0.07, 0.1, 0.14, 0.2, 0.3, 0.45, 0.7, 1.1)),
                  dict(irreversible=True, mct=1, quality_mode="rates")),
    "WebP": (".webp", "quality", (0, 1, 3, 6, 10, 16, 25, 36, 50, 65, 78, 88), dict(method=6)),
    "AVIF": (".avif", "quality", (0, 2, 5, 9, 14, 20, 27, 35, 44, 54, 64, 74), dict(speed=4, advanced={"tune": "psnr"})),
}
COLOURS = {"gscl": "tab:red", "gscl --tune ssim": "tab:orange", "JPEG": "tab:gray", "JPEG 2000": "tab:blue", "WebP": "tab:green",
           "AVIF": "tab:purple", "the paper": "black"}


def measure_gscl(gscl, name, image, rate):
    with tempfile.TemporaryDirectory() as folder:
        row = codec.measure(gscl, image, rate, VARIANTS[name], pathlib.Path(folder))
    return name, image.stem, row["bpp"], row["psnr"], row["ms_ssim"]


def measure_other(gscl, name, image, value):
    suffix, option, _, fixed = OTHERS[name]
    with tempfile.TemporaryDirectory() as folder:
        coded, shown = pathlib.Path(folder, "coded" + suffix), pathlib.Path(folder, "shown.png")
        with Image.open(image) as picture:
            pixels = picture.width * picture.height
            picture.convert("RGB").save(coded, **{option: value}, **fixed)
        with Image.open(coded) as picture:
            picture.convert("RGB").save(shown)
        _, quality = codec.run(gscl, "compare", image, shown, "--json")
        return name, image.stem, 8 * coded.stat().st_size / pixels, quality["psnr"], quality["ms_ssim"]


def measure_all(arguments):
    """Rows (codec, image, bpp, psnr, ms_ssim)."""
    images = codec.images_of(arguments.folder, arguments.only)
    chosen = arguments.codecs.split(",") if arguments.codecs else [*VARIANTS, *OTHERS]
    others = [name for name in OTHERS if name in chosen]
    tasks = [(measure_other, name, image, value) for image in images for name in others for value in OTHERS[name][2]]
    tasks += [(measure_gscl, name, image, rate) for image in images for name in VARIANTS if name in chosen for rate in RATES]
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        return list(pool.map(lambda task: task[0](arguments.gscl, *task[1:]), tasks))


def read_points(path):
    with open(path, newline="", encoding="utf-8") as file:
        return [(row.get("codec", "the paper"), row["image"], float(row["bpp"]), float(row["psnr"]),
                 float(row.get("msssim") or "nan")) for row in csv.DictReader(file)]


def at_rate(points, rate):
    """Linear in the logarithm of the rate; None outside the points (with 3 % of slack)."""
    if not points[0][0] / 1.03 <= rate <= points[-1][0] * 1.03:
        return None
    for (low, a), (high, b) in zip(points, points[1:]):
        if rate <= high or (high, b) == points[-1]:
            return a + (b - a) * (math.log(rate) - math.log(low)) / (math.log(high) - math.log(low))
    return None


def mean_curve(rows, name, column, rates):
    """[(rate, mean over all images)] where every image reaches the rate."""
    images = collections.defaultdict(dict)
    for row in rows:
        if row[0] == name and not math.isnan(row[column]):
            images[row[1]][row[2]] = row[column]
    everyone = [sorted(points.items()) for points in images.values() if len(points) > 1]
    curve = []
    for rate in rates:
        values = [at_rate(points, rate) for points in everyone]
        if values and None not in values:
            curve.append((rate, sum(values) / len(values)))
    return curve


def draw(rows, path):
    figure, axes = pyplot.subplots(1, 2, figsize=(10.5, 4.3), constrained_layout=True)
    fine = [0.025 * 1.03 ** i for i in range(130)]
    names = list(dict.fromkeys(row[0] for row in rows))
    names.sort(key=lambda name: list(COLOURS).index(name) if name in COLOURS else len(COLOURS))
    for axis, column, title in ((axes[0], 3, "PSNR, dB"), (axes[1], 4, "MS-SSIM")):
        for name in names:
            curve = [point for point in mean_curve(rows, name, column, fine) if point[0] <= 1.05]
            style = dict(color=COLOURS.get(name), linewidth=2.2 if name.startswith("gscl") else 1.3)
            if curve:
                axis.plot(*zip(*curve), label=name, **style)
        axis.set(xscale="log", xlabel="bits per pixel", title=title, xlim=(0.028, 1.05))
        axis.set_xticks((0.03, 0.05, 0.1, 0.2, 0.5, 1.0), ("0.03", "0.05", "0.1", "0.2", "0.5", "1"))
        axis.minorticks_off()
        axis.grid(True, alpha=0.3)
    axes[1].set_ylim(0.75, 1.0)
    axes[0].legend(loc="upper left")
    figure.savefig(path, metadata={"Date": None} if str(path).endswith(".svg") else None)


def print_table(rows):
    names = [name for name in COLOURS if any(row[0] == name for row in rows)]
    for column, title, digits in ((3, "PSNR dB", 2), (4, "MS-SSIM", 3)):
        print(f"| {title} | " + " | ".join(f"{rate:g}" for rate in TABLE_RATES) + " |\n|---" + "|---" * len(TABLE_RATES) + "|")
        for name in names:
            found = {rate: dict(mean_curve(rows, name, column, [rate])).get(rate) for rate in TABLE_RATES}
            if any(value is not None for value in found.values()):
                print(f"| {name} | " + " | ".join("-" if v is None else f"{v:.{digits}f}" for v in found.values()) + " |")
        print()


def main():
    parser = codec.parser(__doc__)
    parser.add_argument("--codecs", default="", help="measure these alone, separated by commas: " + ", ".join([*VARIANTS, *OTHERS]))
    parser.add_argument("--plot", default="quality.svg", help="picture to write (default %(default)s)")
    parser.add_argument("--points", action="append", default=[], help="CSV of points measured elsewhere")
    parser.add_argument("--jobs", type=int, default=2, help="encodes at a time (default %(default)s)")
    parser.add_argument("--csv", help="every measured point: codec, image, bpp, psnr, msssim")
    arguments = parser.parse_args()
    rows = measure_all(arguments)
    if arguments.csv:
        with open(arguments.csv, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(("codec", "image", "bpp", "psnr", "msssim"))
            writer.writerows(rows)
    for path in arguments.points:
        rows += read_points(path)
    draw(rows, arguments.plot)
    print_table(rows)


if __name__ == "__main__":
    main()
