#!/usr/bin/env python3
"""Mean PSNR, MS-SSIM and encode time of every effort with --tune psnr over a folder of PNG images, as a Markdown table.

    tests/bench/efforts.py FOLDER [--gscl build/gscl] [--only NAME,NAME] [--rates 0.042,0.183]
                           [--document [RESULTS.md]] [-- ENCODE OPTIONS]
"""
import codec
import document

EFFORTS = range(10)
HEAD = ("effort", "bpp", "PSNR dB", "MS-SSIM", "encode s")
KEYS = {"bpp": ".4f", "psnr": ".2f", "ms_ssim": ".4f", "encode_s": ".2f"}


def measure_effort(arguments, images, effort, rate, work):
    options = [*codec.TUNE_PSNR, "--effort", str(effort), *arguments.options]
    rows = [codec.measure(arguments.gscl, image, float(rate), options, work) for image in images]
    return [str(effort), *(f"{codec.mean(rows, key):{form}}" for key, form in KEYS.items())]


def main():
    parser = codec.parser(__doc__)
    parser.add_argument("--rates", default="0.042,0.183", help="bits per pixel (default %(default)s)")
    document.add_option(parser, "RESULTS.md", "efforts")
    arguments = codec.parse_with_options(parser)
    images = codec.images_of(arguments.folder, arguments.only)
    document.write_section(arguments, images, HEAD, lambda work: [
        measure_effort(arguments, images, effort, rate, work)
        for effort in EFFORTS for rate in arguments.rates.split(",")])


if __name__ == "__main__":
    main()
