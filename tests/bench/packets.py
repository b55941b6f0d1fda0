#!/usr/bin/env python3
"""Quality of pictures in radio packets of which some are lost, in gscl and in other codecs.

    sh tests/bench/bench.sh packets FOLDER [--gscl build/gscl] [--longer 256,0] [--sizes 152,230] [--counts 1,3,5,10]
        [--losses 0,5,10,20,40] [--patterns 20] [--plot FILE] [--csv FILE] [--document [FILE]] [-- OPTIONS OF gscl encode]

A picture is sent as COUNT packets of at most SIZE bytes.  In each of --patterns random patterns every packet is lost with the
same probability, independently of the others; patterns are the same for all codecs and pictures.  The picture that arrives is
compared with the original: mean of PSNR and SSIMULACRA 2 over pictures and patterns.  Where nothing can be drawn, a picture of
one mid grey counts.  --longer is the longer side in pixels to which pictures are reduced first (0: they stay as they are).

  gscl                packets, encoded for no loss
  gscl --packet-loss  packets, encoded for the loss of the column: some are repair packets
  gscl file           one bare file in fragments: its prefix up to the first lost fragment is drawn (gscl decode --partial)
  AVIF, WebP          one file in fragments: all of them are needed
  ... and parity      one fragment less for the file, and the XOR of all others: any one may be lost
  JPEG, restart       with restart markers in each row of blocks; the decoder goes on behind what is lost

All sizes are those of real files.  Fragments of other codecs are taken to need no bytes for themselves.
"""
import io
import pathlib
import random

from PIL import Image, ImageFile

import codec
import document
import other_codecs

ImageFile.LOAD_TRUNCATED_IMAGES = True
GREY = 128
OURS = ("gscl", "gscl --packet-loss", "gscl file")
OTHERS = ("AVIF", "AVIF and parity", "WebP", "WebP and parity", "JPEG, restart")


def patterns_of(count, loss, number):
    """Which packets arrive, as tuples of their numbers."""
    generator = random.Random(f"{count} {loss}")
    return [tuple(k for k in range(count) if generator.random() >= loss / 100) for _ in range(number)]


class Scene:
    """A picture at the size at which it is sent, and the measures of what is drawn of it."""

    def __init__(self, arguments, path, longer, work):
        self.gscl, self.work, self.options = arguments.gscl, work, arguments.options
        self.path = work / f"{path.stem}.png"
        self.image = codec.reduced(path, longer)
        self.image.save(self.path)
        self.drawn = work / "drawn.png"
        self.nothing = self.measure(Image.new("RGB", self.image.size, (GREY,) * 3))

    def measure(self, image=None):
        """The measures of an image, or of the file self.drawn."""
        if image:
            image.resize(self.image.size).save(self.drawn)
        found = codec.compare(self.gscl, self.path, self.drawn)
        return found["psnr"], found["ssimulacra2"]

    def measure_gscl(self, files, *options):
        codec.run(self.gscl, "decode", *files, "-o", self.drawn, "--device", "host", *options)
        return self.measure()


def packets(scene, size, count, loss):
    """What arrives of gscl's packets: a function of the numbers of those that do."""
    for old in scene.work.glob("*.gsclp"):
        old.unlink()
    codec.run(scene.gscl, "encode", scene.path, "--out-dir", scene.work, "--packets", size, "--packet-count", count,
              "--packet-loss", loss / 100, "--quiet", "--device", "host", *scene.options)
    contents = [file.read_bytes() for file in sorted(scene.work.glob("*.gsclp"))]
    assert len(contents) == count and max(map(len, contents)) <= size

    def draw(numbers):
        files = [scene.work / f"{number:03}.gsclp" for number in numbers]
        for number, file in zip(numbers, files):
            file.write_bytes(contents[number])
        if not numbers:
            return scene.nothing
        try:
            return scene.measure_gscl(files)
        except SystemExit:  # repair packets alone
            return scene.nothing
    return draw


def gscl_file(scene, size, count):
    file = scene.work / "file.gscl"
    codec.run(scene.gscl, "encode", scene.path, "-o", file, "--bytes", size * count, "--bare", "--quiet", "--device", "host",
              *scene.options)
    data = file.read_bytes()

    def draw(numbers):
        first_lost = next((k for k in range(count) if k not in numbers), count)
        part = data[:first_lost * size]
        if not part:
            return scene.nothing
        file.write_bytes(part)
        return scene.measure_gscl([file], "--bare", *(["--partial"] if part != data else []))
    return draw


def whole_file(scene, size, count, name, parity):
    """A file of which all fragments are needed, but for one with parity."""
    fragments = count - parity
    files = other_codecs.Picture(scene.path, name).around(size * fragments) if fragments else []
    if not files:
        return lambda numbers: scene.nothing
    with Image.open(io.BytesIO(files[0])) as opened:
        whole = scene.measure(opened.convert("RGB"))
    return lambda numbers: whole if len(numbers) >= fragments else scene.nothing


def jpeg_with_restarts(image, quality):
    file = io.BytesIO()
    image.save(file, "JPEG", quality=quality, optimize=True, restart_marker_rows=1)
    return file.getvalue()


def jpeg(scene, size, count):
    """What is lost is cut out; its header is needed whole."""
    files = other_codecs.around(lambda quality: jpeg_with_restarts(scene.image, quality), size * count)
    if not files:
        return lambda numbers: scene.nothing
    data = files[0]
    header = data.index(b"\xff\xda") + 14  # the start of the scan, with its own header

    def draw(numbers):
        if any(start // size not in numbers for start in range(0, header, size)):
            return scene.nothing
        left = b"".join(data[k * size:(k + 1) * size] for k in numbers)
        with Image.open(io.BytesIO(left)) as opened:
            return scene.measure(opened.convert("RGB"))
    return draw


def sender(scene, size, count, name, loss):
    if name == "gscl":
        return packets(scene, size, count, 0)
    if name == "gscl --packet-loss":
        return packets(scene, size, count, loss)
    if name == "gscl file":
        return gscl_file(scene, size, count)
    if name == "JPEG, restart":
        return jpeg(scene, size, count)
    return whole_file(scene, size, count, name.split()[0], name.endswith("parity"))


def measure_name(arguments, scene, size, count, name):
    """Rows of one codec: a mean over the patterns for each loss.  What has been drawn is not drawn again."""
    rows, seen, draw = [], {}, None
    for loss in arguments.losses:
        if draw is None or name == "gscl --packet-loss":
            draw, seen = sender(scene, size, count, name, loss), {}
        drawn = []
        for numbers in patterns_of(count, loss, arguments.patterns if loss else 1):
            if numbers not in seen:
                seen[numbers] = draw(numbers)
            drawn.append(seen[numbers])
        rows.append(dict(codec=name, size=size, count=count, loss=loss, psnr=sum(p for p, _ in drawn) / len(drawn),
                         lowest=min(p for p, _ in drawn), ssimulacra2=sum(s for _, s in drawn) / len(drawn)))
    return rows


def measure_image(arguments, path, work):
    rows = []
    for longer in arguments.longer:
        scene = Scene(arguments, path, longer, work)
        for size in arguments.sizes:
            for count in arguments.counts:
                for name in OURS + OTHERS:
                    for row in measure_name(arguments, scene, size, count, name):
                        rows.append(dict(image=path.stem, longer=longer, **row))
    return rows


def table(arguments, rows, longer, size):
    """Lines of Markdown: PSNR and SSIMULACRA 2 of each codec and count by loss."""
    heads = [f"{loss} %" for loss in arguments.losses]
    lines = [f"| packets of {size} bytes | codec | " + " | ".join(heads) + " |", "|---" * (len(heads) + 2) + "|"]
    for count in arguments.counts:
        for name in OURS + OTHERS:
            cells = []
            for loss in arguments.losses:
                of = [row for row in rows if (row["longer"], row["size"], row["count"], row["codec"], row["loss"]) ==
                      (longer, size, count, name, loss)]
                cells.append(f"{codec.mean(of, 'psnr'):.1f}, {codec.mean(of, 'ssimulacra2'):.0f}")
            lines.append(f"| {count} | {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def plot(arguments, rows, path):
    """Mean PSNR by loss, for the largest count, of each size of pictures."""
    import plots
    figure, axes = plots.pyplot.subplots(1, len(arguments.longer), figsize=(5 * len(arguments.longer), 4), squeeze=False)
    for axis, longer in zip(axes[0], arguments.longer):
        for name in OURS + OTHERS:
            of = [[row for row in rows if (row["longer"], row["size"], row["count"], row["codec"], row["loss"]) ==
                   (longer, arguments.sizes[0], arguments.counts[-1], name, loss)] for loss in arguments.losses]
            axis.plot(arguments.losses, [codec.mean(group, "psnr") for group in of], label=name,
                      linewidth=2 if name in OURS[:2] else 1)
        axis.set(xlabel="packets lost (%)", ylabel="PSNR (dB), mean",
                 title=f"{arguments.counts[-1]} packets of {arguments.sizes[0]} bytes, " +
                       (f"longer side {longer}" if longer else "full size"))
    axes[0][-1].legend(fontsize=7)
    figure.tight_layout()
    plots.save(figure, path)


def numbers(text):
    return [int(word) for word in text.split(",")]


def main():
    parser = codec.parser(__doc__)
    parser.add_argument("--longer", type=numbers, default=[256, 0])
    parser.add_argument("--sizes", type=numbers, default=[152, 230])
    parser.add_argument("--counts", type=numbers, default=[1, 3, 5, 10])
    parser.add_argument("--losses", type=numbers, default=[0, 5, 10, 20, 40])
    parser.add_argument("--patterns", type=int, default=20)
    parser.add_argument("--plot", type=pathlib.Path)
    parser.add_argument("--csv")
    document.add_option(parser, "PACKETS.md", "packets")
    arguments = codec.parse_with_options(parser)
    section = document.section_of(arguments)
    rows = codec.measured(arguments, codec.images_of(arguments.folder, arguments.only), measure_image)
    parts = [f"{len({row['image'] for row in rows})} pictures, {arguments.patterns} patterns: mean PSNR in dB, SSIMULACRA 2.\n"]
    for longer in arguments.longer:
        parts.append(f"Longer side {longer} pixels:\n" if longer else "Full size:\n")
        parts += [table(arguments, rows, longer, size) for size in arguments.sizes]
    document.publish(section, *parts)
    if arguments.plot:
        plot(arguments, rows, arguments.plot)


if __name__ == "__main__":
    main()
