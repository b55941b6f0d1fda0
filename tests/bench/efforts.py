#!/usr/bin/env python3
"""What each effort costs and gives: mean PSNR, MS-SSIM and encode time over a folder of PNG images, as a Markdown table.

    tests/bench/ladder.py FOLDER [--gscl build/gscl] [--only NAME,NAME] [--rates 0.042,0.183] [-- ENCODE OPTIONS]
"""
import pathlib
import tempfile

import codec


def main():
    parser = codec.parser(__doc__)
    parser.add_argument("--rates", default="0.042,0.183", help="bits per pixel (default %(default)s)")
    arguments = codec.parse_with_options(parser)
    images = codec.images_of(arguments.folder, arguments.only)
    print("| effort | bpp | PSNR dB | MS-SSIM | encode s |\n|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for effort in range(10):
            for rate in arguments.rates.split(","):
                options = ["--effort", str(effort), *arguments.options]
                rows = [codec.measure(arguments.gscl, image, float(rate), options, pathlib.Path(folder)) for image in images]
                print("| {} | {:.4f} | {:.2f} | {:.4f} | {:.2f} |".format(
                    effort, *(codec.mean(rows, key) for key in ("bpp", "psnr", "ms_ssim", "encode_s"))), flush=True)


if __name__ == "__main__":
    main()
