#!/usr/bin/env python3
"""Mean PSNR, MS-SSIM and encode time of every effort over a folder of PNG images, as a Markdown table.

    tests/bench/efforts.py FOLDER [--gscl build/gscl] [--only NAME,NAME] [--rates 0.042,0.183]
                           [--document [RESULTS.md]] [-- ENCODE OPTIONS]
"""
import pathlib
import tempfile

import codec
import document

EFFORTS = range(10)
KEYS = {"bpp": ".4f", "psnr": ".2f", "ms_ssim": ".4f", "encode_s": ".2f"}


def measure_effort(arguments, images, effort, rate, work):
    options = ["--effort", str(effort), *arguments.options]
    rows = [codec.measure(arguments.gscl, image, float(rate), options, work) for image in images]
    return [str(effort), *(f"{codec.mean(rows, key):{form}}" for key, form in KEYS.items())]


def main():
    parser = codec.parser(__doc__)
    parser.add_argument("--rates", default="0.042,0.183", help="bits per pixel (default %(default)s)")
    document.add_option(parser, "RESULTS.md", "efforts")
    arguments = codec.parse_with_options(parser)
    section = document.section_of(arguments)
    images = codec.images_of(arguments.folder, arguments.only)
    with tempfile.TemporaryDirectory() as folder:
        rows = [measure_effort(arguments, images, effort, rate, pathlib.Path(folder))
                for effort in EFFORTS for rate in arguments.rates.split(",")]
    document.publish(section, document.origin("tests/bench/efforts.py FOLDER", len(images)),
                     document.table(("effort", "bpp", "PSNR dB", "MS-SSIM", "encode s"), rows))


if __name__ == "__main__":
    main()
