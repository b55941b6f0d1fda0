#!/usr/bin/env python3
"""Time and memory of encodes of large photographs, and how right the time is that the progress line shows.

    sh tests/bench/bench.sh large FOLDER [--gscl build/gscl] [--only NAME,NAME] [--megapixels 2,6,14,25,48] [--efforts 0,2,5]
                                  [--document [FILE]] [-- OPTIONS OF gscl encode]

FOLDER: photographs, as PNG or JPEG.  Each size is that of a photograph which has as many pixels or more and is shrunk; where none
has, the largest is enlarged, which the table says.  "error of the time left" is the largest difference between the time that the
terminal shows and the time that is really left, as a share of the latter, from a tenth to a half of the time; "of the whole time"
is the same difference as a share of the whole time, from a tenth to the end.
"""
import math
import os
import pathlib
import pty
import re
import subprocess
import tempfile
import time

from PIL import Image

import codec
import document
from process import Run

HEAD = ("megapixels", "photograph", "effort", "bytes", "seconds", "of all cores", "MiB", "error of the time left", "of the whole time")
SHOWN = re.compile(rb" ([\d.]+) s left")

Image.MAX_IMAGE_PIXELS = None


class Encode(Run):
    """An encode whose messages go to a terminal, with what it showed as (seconds since the start, seconds left)."""

    def begin(self, words, env):
        self.terminal, other_end = pty.openpty()
        process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=other_end, env=env)
        os.close(other_end)
        return process

    def listen(self, process):
        self.shown, text = [], b""
        while chunk := self.read():
            text = (text + chunk)[-400:]
            left = SHOWN.findall(text)
            if left:
                self.shown.append((time.perf_counter() - self.start_s, float(left[-1])))
        os.close(self.terminal)
        return text

    def read(self):
        try:
            return os.read(self.terminal, 4096)
        except OSError:  # closed at the other end
            return b""

    def errors(self, until):
        """Of the seconds left that were shown from a tenth to this share of the time: seconds, and seconds really left."""
        return [(abs(left - (self.wall_s - now)), self.wall_s - now)
                for now, left in self.shown if 0.1 <= now / self.wall_s <= until]

    def error_of_time_left(self):
        return max((error / left for error, left in self.errors(0.5)), default=math.nan)

    def error_of_whole_time(self):
        return max((error / self.wall_s for error, _ in self.errors(1)), default=math.nan)


def photographs_of(folder, only):
    paths = [path for path in sorted(pathlib.Path(folder).rglob("*")) if path.suffix.lower() in (".png", ".jpg", ".jpeg")]
    found = []
    for path in paths:
        if not only or path.stem in only.split(","):
            with Image.open(path) as image:
                found.append((image.width * image.height, path))
    if not found:
        raise SystemExit(f"{folder}: holds no PNG or JPEG image of the names given; name a folder of photographs")
    return sorted(found)


def resize(photographs, megapixels, output):
    """Writes a photograph of that size; returns what the table calls it."""
    pixels = megapixels * 1e6
    area, path = next((found for found in photographs if found[0] >= pixels), photographs[-1])
    scale = math.sqrt(pixels / area)
    with Image.open(path) as image:
        image.convert("RGB").resize((round(image.width * scale), round(image.height * scale)), Image.LANCZOS).save(output)
    return path.stem + (" (enlarged)" if scale > 1 else "")


def measure(arguments, photographs, work):
    image, coded = work / "image.png", work / "coded.gscl"
    for megapixels in arguments.megapixels:
        name = resize(photographs, megapixels, image)
        for effort in arguments.efforts:
            run = Encode(arguments.gscl, "encode", image, "-o", coded, "--effort", effort, *arguments.options)
            yield [f"{megapixels:g}", name, str(effort), str(coded.stat().st_size), f"{run.wall_s:.1f}", f"{run.cpu_s:.1f}",
                   f"{run.memory_mib:.0f}", f"{100 * run.error_of_time_left():.0f} %", f"{100 * run.error_of_whole_time():.0f} %"]


def numbers(text):
    return [float(word) if "." in word else int(word) for word in text.split(",")]


def main():
    parser = codec.parser(__doc__)
    parser.add_argument("--megapixels", type=numbers, default=[2, 6, 14, 25, 48])
    parser.add_argument("--efforts", type=numbers, default=[0, 2, 5])
    document.add_option(parser, "SPEED.md", "large")
    arguments = codec.parse_with_options(parser)
    section = document.section_of(arguments)
    photographs = photographs_of(arguments.folder, arguments.only)
    with tempfile.TemporaryDirectory() as folder:
        rows = list(measure(arguments, photographs, pathlib.Path(folder)))
    document.publish(section, document.origin("sh tests/bench/bench.sh large FOLDER", len({row[1] for row in rows})),
                     document.table(HEAD, rows))


if __name__ == "__main__":
    main()
