#!/usr/bin/env python3
"""The ablations of the paper (its table 3): the loss L1 + SSIM against L1 and L2, and codebook sizes chosen by rate
against fixed ones.  Each row shows the difference to the full scheme at the same rate.

    tests/bench/ablation.py FOLDER [--gscl build/gscl] [--only NAME,NAME] [--rate 0.125] [--document [RESULTS.md]]
"""
import codec
import document

FULL = "full scheme (L1 + SSIM, k by rate)"
HEAD = ("variant", "PSNR dB", "difference", "SSIM", "difference")
VARIANTS = {FULL: [], "L1 alone": ["--loss", "l1"], "L2": ["--loss", "l2"],
            **{f"k = {k}": ["--codebook", str(k)] for k in (16, 32, 64, 128)}}


def measure_variant(arguments, images, options, work):
    """Mean PSNR and SSIM."""
    rows = [codec.measure(arguments.gscl, image, arguments.rate, ["--profile", "paper", *options], work) for image in images]
    return codec.mean(rows, "psnr"), codec.mean(rows, "ssim")


def table_rows(arguments, images, work):
    means = {name: measure_variant(arguments, images, options, work) for name, options in VARIANTS.items()}
    full = means[FULL]
    return [[name, f"{psnr:.2f}", f"{psnr - full[0]:+.2f}", f"{ssim:.4f}", f"{ssim - full[1]:+.4f}"]
            for name, (psnr, ssim) in means.items()]


def main():
    parser = codec.parser(__doc__)
    parser.add_argument("--rate", type=float, default=0.125, help="bits per pixel (default %(default)s)")
    document.add_option(parser, "RESULTS.md", "ablation")
    arguments = parser.parse_args()
    images = codec.images_of(arguments.folder, arguments.only)
    document.write_section(arguments, images, HEAD, lambda work: table_rows(arguments, images, work))


if __name__ == "__main__":
    main()
