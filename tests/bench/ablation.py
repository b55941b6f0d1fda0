#!/usr/bin/env python3
"""The paper's ablations (its table 3): loss L1 + SSIM against L1 alone, and codebook sizes chosen by rate against
fixed ones, each as the difference to the full scheme at the same rate.

    tests/bench/ablation.py FOLDER [--gscl build/gscl] [--only NAME,NAME] [--rate 0.125]
"""
import pathlib
import tempfile

import codec

VARIANTS = [("full scheme (L1 + SSIM, k by rate)", []), ("L1 alone", ["--loss", "l1"]), ("L2", ["--loss", "l2"])] + [
    (f"k = {k}", ["--codebook", str(k)]) for k in (16, 32, 64, 128)]


def main():
    parser = codec.parser(__doc__)
    parser.add_argument("--rate", type=float, default=0.125, help="bits per pixel (default %(default)s)")
    arguments = parser.parse_args()
    print("| variant | PSNR dB | difference | SSIM | difference |\n|---|---|---|---|---|")
    full = None
    with tempfile.TemporaryDirectory() as folder:
        for name, options in VARIANTS:
            rows = [codec.measure(arguments.gscl, image, arguments.rate, ["--profile", "paper", *options], pathlib.Path(folder))
                    for image in codec.images_of(arguments.folder, arguments.only)]
            psnr, ssim = codec.mean(rows, "psnr"), codec.mean(rows, "ssim")
            full = full or (psnr, ssim)
            print(f"| {name} | {psnr:.2f} | {psnr - full[0]:+.2f} | {ssim:.4f} | {ssim - full[1]:+.4f} |", flush=True)


if __name__ == "__main__":
    main()
