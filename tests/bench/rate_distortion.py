#!/usr/bin/env python3
"""Rate, quality and time of gscl on a folder of PNG images, as a Markdown table of means.

    tests/bench/rate_distortion.py FOLDER [--gscl build/gscl] [--rates 0.042,0.066,0.125,0.183] [--csv FILE]
                                   [--document [RESULTS.md]] [--section rates] [-- ENCODE OPTIONS]
"""
import pathlib
import tempfile

import codec
import document

KEYS = {"bpp": ".4f", "psnr": ".2f", "ssim": ".4f", "ms_ssim": ".4f", "splats": ".0f", "encode_s": ".2f", "decode_s": ".3f"}
HEAD = ("bpp", "PSNR dB", "SSIM", "MS-SSIM", "splats", "encode s", "decode s", "over budget")


def row_of(measured):
    means = [f"{codec.mean(measured, key):{form}}" for key, form in KEYS.items()]
    return [*means, f"{sum(row['over'] for row in measured)} of {len(measured)}"]


def main():
    parser = codec.parser(__doc__)
    parser.add_argument("--rates", default="0.042,0.066,0.125,0.183", help="bits per pixel (default %(default)s)")
    parser.add_argument("--csv", help="file for one row per image and rate")
    document.add_option(parser, "RESULTS.md", "rates")
    parser.add_argument("--section", help="section of the document (default %(default)s)")
    arguments = codec.parse_with_options(parser)
    section = document.section_of(arguments)
    images = codec.images_of(arguments.folder, arguments.only)
    measured = []
    with tempfile.TemporaryDirectory() as folder:
        for rate in arguments.rates.split(","):
            measured.append([codec.measure(arguments.gscl, image, float(rate), arguments.options, pathlib.Path(folder))
                             for image in images])
    if arguments.csv:
        codec.write_csv(arguments.csv, [row for rows in measured for row in rows])
    command = " ".join(["tests/bench/rate_distortion.py FOLDER", *(["--", *arguments.options] if arguments.options else [])])
    document.publish(section, document.origin(command, len(images)), document.table(HEAD, map(row_of, measured)))


if __name__ == "__main__":
    main()
