#!/usr/bin/env python3
"""PSNR of the first part of a file, with and without --progressive, beside whole files of that size, as a Markdown table.
All with --tune psnr.

    tests/bench/progressive.py FOLDER [--gscl build/gscl] [--only NAME,NAME] [--bytes 2064,8994]
                               [--document [RESULTS.md]]
"""
import codec
import document

SHARES = (5, 10, 25, 50, 75, 100)  # percent of the file
HEAD = ("bytes", "part", "whole file of that size", "default", "difference", "`--progressive`", "difference")


def encode(arguments, image, size, work, *options):
    """The bytes of a file of at most `size` bytes."""
    coded = work / "image.gscl"
    codec.run(arguments.gscl, "encode", image, "-o", coded, "--bytes", size, *codec.TUNE_PSNR, "--quiet", *options)
    return coded.read_bytes()


def psnr(arguments, image, data, work):
    part, decoded = work / "part.gscl", work / "part.png"
    part.write_bytes(data)
    codec.run(arguments.gscl, "decode", "--partial", part, "-o", decoded)
    return codec.compare(arguments.gscl, image, decoded)["psnr"]


def measure(arguments, image, size, work):
    """A row for each share: PSNR of a whole file, of a part of a default file, and of a part of a progressive one."""
    plain, layered = encode(arguments, image, size, work), encode(arguments, image, size, work, "--progressive")
    rows = []
    for share in SHARES:
        whole = plain if share == 100 else encode(arguments, image, size * share // 100, work)
        rows.append([psnr(arguments, image, data, work)
                     for data in (whole, plain[:len(plain) * share // 100], layered[:len(layered) * share // 100])])
    return rows


def table_rows(arguments, images, size, work):
    measured = [measure(arguments, image, size, work) for image in images]
    for i, share in enumerate(SHARES):
        whole, plain, layered = (sum(rows[i][k] for rows in measured) / len(measured) for k in range(3))
        yield [str(size), f"{share} %", f"{whole:.2f}", f"{plain:.2f}", f"{plain - whole:+.2f}", f"{layered:.2f}",
               f"{layered - whole:+.2f}"]


def main():
    parser = codec.parser(__doc__)
    parser.add_argument("--bytes", default="2064,8994", help="sizes of the files (default %(default)s)")
    document.add_option(parser, "RESULTS.md", "progressive")
    arguments = parser.parse_args()
    images = codec.images_of(arguments.folder, arguments.only)
    document.write_section(arguments, images, HEAD, lambda work: [
        row for size in arguments.bytes.split(",") for row in table_rows(arguments, images, int(size), work)])


if __name__ == "__main__":
    main()
