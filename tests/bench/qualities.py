#!/usr/bin/env python3
"""What the qualities of `gscl encode -q` give: rate, score and time, beside a plain encode of as many bytes.

    sh tests/bench/bench.sh qualities FOLDER [--gscl build/gscl] [--only NAME,NAME] [--longer 384] [--qualities 10,30,50,70,90]
                                      [--csv FILE] [--document [FILE]] [-- OPTIONS OF gscl encode]

--longer is the longer side in pixels to which pictures are reduced first (0: they stay as they are).  "time" is that of all
encodes of the search in times of one encode with --bytes of the size that was found; "fewer bytes" counts the images for which a
quality takes fewer bytes than the one before it.
"""
import resource

import codec
import document

HEAD = ("quality", "bits per pixel", "lowest", "highest", "SSIMULACRA 2", "PSNR dB", "encodes", "time", "fewer bytes")


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def encode(arguments, image, coded, *options):
    """The report, and the seconds of all processors."""
    before = processor_seconds()
    _, report = codec.run(arguments.gscl, "encode", image, "-o", coded, "--quiet", "--json", *options, *arguments.options)
    return report, processor_seconds() - before


def measure_image(arguments, path, work):
    image, coded = work / f"{path.stem}.png", work / "coded.gscl"
    codec.reduced(path, arguments.longer).save(image)
    rows = []
    for quality in arguments.qualities:
        found, seconds = encode(arguments, image, coded, "-q", quality)
        _, plain_seconds = encode(arguments, image, coded, "--bytes", found["bytes"])
        rows.append(dict(image=path.stem, quality=quality, bytes=found["bytes"], bpp=found["bpp"], psnr=found["psnr"],
                         ssimulacra2=found["ssimulacra2"], trials=found["trials"], times=seconds / plain_seconds,
                         falls=bool(rows) and found["bytes"] < rows[-1]["bytes"]))
    return rows


def cells(rows, quality):
    of = [row for row in rows if row["quality"] == quality]
    rates = [row["bpp"] for row in of]
    means = (f"{codec.mean(of, key):.1f}" for key in ("ssimulacra2", "psnr", "trials", "times"))
    return [str(quality), f"{codec.mean(of, 'bpp'):.3f}", f"{min(rates):.3f}", f"{max(rates):.3f}", *means,
            f"{sum(row['falls'] for row in of)} of {len(of)}"]


def main():
    parser = codec.parser(__doc__)
    parser.add_argument("--longer", type=int, default=384)
    parser.add_argument("--qualities", type=lambda text: [int(word) for word in text.split(",")], default=[10, 30, 50, 70, 90])
    parser.add_argument("--csv")
    document.add_option(parser, "RESULTS.md", "qualities")
    arguments = codec.parse_with_options(parser)
    section = document.section_of(arguments)
    images = codec.images_of(arguments.folder, arguments.only)
    rows = codec.measured(arguments, images, measure_image)
    document.publish(section, document.origin("sh tests/bench/bench.sh qualities FOLDER", len(images)),
                     document.table(HEAD, [cells(rows, quality) for quality in arguments.qualities]))


if __name__ == "__main__":
    main()
