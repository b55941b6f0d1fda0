#!/usr/bin/env python3
"""Mean quality of every `gscl encode --tune` over a folder of PNG images, as a Markdown table.

    tests/bench/tune.py FOLDER [--gscl build/gscl] [--only NAME,NAME] [--rates 0.042,0.066,0.125,0.183]
                        [--document [RESULTS.md]]
"""
import codec
import document

TUNES = ("psnr", "ssim", "visual")
HEAD = ("bits per pixel", "tune", "PSNR dB", "MS-SSIM", "SSIMULACRA 2")
KEYS = {"psnr": ".2f", "ms_ssim": ".3f", "ssimulacra2": ".1f"}


def row_of(arguments, images, rate, tune, work):
    rows = [codec.measure(arguments.gscl, image, float(rate), ["--tune", tune], work) for image in images]
    return [rate, tune, *(f"{codec.mean(rows, key):{form}}" for key, form in KEYS.items())]


def main():
    parser = codec.parser(__doc__)
    parser.add_argument("--rates", default="0.042,0.066,0.125,0.183", help="bits per pixel (default %(default)s)")
    document.add_option(parser, "RESULTS.md", "tune")
    arguments = parser.parse_args()
    images = codec.images_of(arguments.folder, arguments.only)
    document.write_section(arguments, images, HEAD, lambda work: [
        row_of(arguments, images, rate, tune, work) for rate in arguments.rates.split(",") for tune in TUNES])


if __name__ == "__main__":
    main()
