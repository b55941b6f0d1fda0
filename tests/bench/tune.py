#!/usr/bin/env python3
"""Mean quality of `gscl encode --tune ssim` beside the default over a folder of PNG images, as a Markdown table.

    tests/bench/tune.py FOLDER [--gscl build/gscl] [--only NAME,NAME] [--rates 0.042,0.066,0.125,0.183]
                        [--document [RESULTS.md]]
"""
import codec
import document

HEAD = ("bits per pixel", "MS-SSIM, default", "MS-SSIM, `--tune ssim`", "PSNR, default", "PSNR, `--tune ssim`")


def row_of(arguments, images, rate, work):
    psnr, ssim = ([codec.measure(arguments.gscl, image, float(rate), ["--tune", tune], work) for image in images]
                  for tune in ("psnr", "ssim"))
    return [rate, f"{codec.mean(psnr, 'ms_ssim'):.3f}", f"{codec.mean(ssim, 'ms_ssim'):.3f}",
            f"{codec.mean(psnr, 'psnr'):.2f}", f"{codec.mean(ssim, 'psnr'):.2f}"]


def main():
    parser = codec.parser(__doc__)
    parser.add_argument("--rates", default="0.042,0.066,0.125,0.183", help="bits per pixel (default %(default)s)")
    document.add_option(parser, "RESULTS.md", "tune")
    arguments = parser.parse_args()
    images = codec.images_of(arguments.folder, arguments.only)
    document.write_section(arguments, images, HEAD, lambda work: [
        row_of(arguments, images, rate, work) for rate in arguments.rates.split(",")])


if __name__ == "__main__":
    main()
