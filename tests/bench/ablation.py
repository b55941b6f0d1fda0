#!/usr/bin/env python3
"""The ablations of the paper (its table 3): the loss L1 + SSIM against L1 and L2, and codebook sizes chosen by rate
against fixed ones.  Each row shows the difference to the full scheme at the same rate.

    tests/bench/ablation.py FOLDER [--gscl build/gscl] [--only NAME,NAME] [--rate 0.125] [--document [RESULTS.md]]
"""
import pathlib
import tempfile

import codec
import document

FULL = "full scheme (L1 + SSIM, k by rate)"
VARIANTS = {FULL: [], "L1 alone": ["--loss", "l1"], "L2": ["--loss", "l2"],
            **{f"k = {k}": ["--codebook", str(k)] for k in (16, 32, 64, 128)}}


def measure_variant(arguments, images, options, work):
    """Mean PSNR and SSIM."""
    rows = [codec.measure(arguments.gscl, image, arguments.rate, ["--profile", "paper", *options], work) for image in images]
    return codec.mean(rows, "psnr"), codec.mean(rows, "ssim")


def main():
    parser = codec.parser(__doc__)
    parser.add_argument("--rate", type=float, default=0.125, help="bits per pixel (default %(default)s)")
    document.add_option(parser, "RESULTS.md", "ablation")
    arguments = parser.parse_args()
    section = document.section_of(arguments)
    images = codec.images_of(arguments.folder, arguments.only)
    with tempfile.TemporaryDirectory() as folder:
        means = {name: measure_variant(arguments, images, options, pathlib.Path(folder)) for name, options in VARIANTS.items()}
    full = means[FULL]
    rows = [[name, f"{psnr:.2f}", f"{psnr - full[0]:+.2f}", f"{ssim:.4f}", f"{ssim - full[1]:+.4f}"]
            for name, (psnr, ssim) in means.items()]
    document.publish(section, document.origin("tests/bench/ablation.py FOLDER", len(images)),
                     document.table(("variant", "PSNR dB", "difference", "SSIM", "difference"), rows))


if __name__ == "__main__":
    main()
