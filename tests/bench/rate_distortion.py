#!/usr/bin/env python3
"""Rate, quality and time of gscl on a folder of PNG images, as a Markdown table of means.

    tests/bench/rate_distortion.py FOLDER [--gscl build/gscl] [--rates 0.042,0.066,0.125,0.183] [--csv FILE] [-- ENCODE OPTIONS]
"""
import csv
import pathlib
import tempfile

import codec


def main():
    parser = codec.parser(__doc__)
    parser.add_argument("--rates", default="0.042,0.066,0.125,0.183", help="bits per pixel (default %(default)s)")
    parser.add_argument("--csv", help="one row for each image and rate")
    arguments = codec.parse_with_options(parser)
    rows = []
    print("| bpp | PSNR dB | SSIM | MS-SSIM | splats | encode s | decode s | over budget |\n|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for rate in arguments.rates.split(","):
            some = [codec.measure(arguments.gscl, image, float(rate), arguments.options, pathlib.Path(folder))
                    for image in codec.images_of(arguments.folder, arguments.only)]
            rows += some
            print("| {:.4f} | {:.2f} | {:.4f} | {:.4f} | {:.0f} | {:.2f} | {:.3f} | {} of {} |".format(
                *(codec.mean(some, key) for key in ("bpp", "psnr", "ssim", "ms_ssim", "splats", "encode_s", "decode_s")),
                sum(row["over"] for row in some), len(some)), flush=True)
    if arguments.csv:
        with open(arguments.csv, "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, rows[0].keys())
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    main()
