#!/usr/bin/env python3
"""The loss at half and at twice the value of each tunable: builds the tool with the changed value and encodes.

    sh tests/bench/bench.sh tunables FOLDER [--only NAME,NAME] [--drawings NAME,NAME] [--rooms fit,scalar] [--rate 0.125] [--jobs 2] [--document]

FOLDER holds PNG photographs; the drawings on which effects depend come from scenes.py and scenes_held_out.py.  Tunables are the
fields `.name = number` of host/lib/ROOM/tunables.c.  Each value is halved and doubled (integers are rounded, 0 is skipped)
in a copy of the sources.  The mean PSNR of the photographs, that of the drawings, and the processor time are compared with those
of the defaults.  Each room has a section of its own in TUNABLES.md, which also states how much the seed alone changes these means: a
smaller difference is not significant.  All encodes have --tune psnr.
"""
import concurrent.futures
import json
import os
import pathlib
import queue
import re
import shutil
import statistics
import subprocess
import tempfile
import threading

import codec
import document
import scenes
import scenes_held_out

ROOT = pathlib.Path(__file__).resolve().parents[2]
FIELD = re.compile(r"\.(\w+)\s*=\s*([^,{}]+?)(?=\s*[,}])")
DRAWINGS = {scenes: ("dots", "windows"), scenes_held_out: ("photo_framed",)}
PAPER_ROOM = "codebook"
PAPER_EFFORT = 0  # the profile is slow, and has many tunables
SEEDS = (1, 2, 3)
FACTORS = (0.5, 2)
MAX_ENCODE_S = 120  # of one encode


def fields_of(room):
    """(name, C expression) of each tunable of a room, but for tables."""
    path = ROOT / "host/lib" / room / "tunables.c"
    return FIELD.findall(path.read_text(encoding="utf-8"))


def changed(expression, factor):
    """The expression with another value, or None where nothing changes."""
    if re.fullmatch(r"-?\d+", expression):
        other = round(int(expression) * factor) or 1
        return None if other == int(expression) else str(other)
    if "<<" in expression:
        return f"({expression}) / 2" if factor < 1 else f"({expression}) * 2"
    return f"({expression}) * {float(factor)}" + ("f" if expression.endswith("f") else "")


class Tree:
    """A copy of the sources with a build folder of its own."""

    def __init__(self, folder):
        self.sources, self.build = folder / "sources", folder / "build"
        files = subprocess.run(["git", "-C", ROOT, "ls-files"], check=True, capture_output=True, text=True).stdout.splitlines()
        for name in files:
            (self.sources / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, self.sources / name)
        subprocess.run(["meson", "setup", self.build, self.sources, "-Dtests=disabled"], check=True, stdout=subprocess.DEVNULL)

    def gscl(self, room, name="", new=""):
        """Builds with another value of one of the room's tunables; returns the tool, or None where it does not build."""
        path = self.sources / "host/lib" / room / "tunables.c"
        original = path.read_text(encoding="utf-8")
        text = FIELD.sub(lambda match: f".{name} = {new}" if match[1] == name else match[0], original)
        path.write_text(text if name else original, encoding="utf-8")
        try:
            done = subprocess.run(["ninja", "-C", self.build, "gscl", "gscl-imageio.so"], capture_output=True, text=True)
        finally:
            path.write_text(original, encoding="utf-8")
        return self.build / "gscl" if done.returncode == 0 else None


def encode(words):
    """Runs gscl encode; returns (its report, seconds of processor time), or None where it failed or took longer than MAX_ENCODE_S."""
    with tempfile.TemporaryFile("w+") as output:
        process = subprocess.Popen([str(word) for word in words], stdout=output, stderr=subprocess.DEVNULL)
        timer = threading.Timer(MAX_ENCODE_S, process.kill)
        timer.start()
        _, status, usage = os.wait4(process.pid, 0)
        timer.cancel()
        output.seek(0)
        return (json.load(output), usage.ru_utime + usage.ru_stime) if status == 0 else None


def measure(gscl, images, rate, options, seed, work):
    """(mean PSNR of the photographs, mean PSNR of the drawings, mean processor seconds), or None where an encode failed."""
    means, seconds = [], []
    for group in images:
        psnrs = []
        for image in group:
            done = encode([gscl, "encode", image, "-o", work / "coded.gscl", "--bpp", rate, "--seed", seed,
                           *codec.TUNE_PSNR, "--quiet", "--json", *options])
            if done is None:
                return None
            psnrs.append(done[0]["psnr"] if done[0]["psnr"] is not None else 99.0)
            seconds.append(done[1])
        means.append(statistics.mean(psnrs))
    return *means, statistics.mean(seconds)


def variants_of(rooms):
    for room in rooms:
        for name, expression in fields_of(room):
            for factor in FACTORS:
                new = changed(expression, factor)
                if new:
                    yield room, name, factor, new


def cell(result, default):
    if result is None:
        return "refused"
    return f"{result[0] - default[0]:+.2f}, {result[1] - default[1]:+.2f}, x{result[2] / default[2]:.2f}"


def lines_of(room, profiles, results, count, rate):
    """The section of a room."""
    default = results[profiles[0]]
    spreads = [statistics.stdev(results[task][group] for task in profiles) for group in (0, 1)]
    profile = f"paper profile, effort {PAPER_EFFORT}" if room == PAPER_ROOM else "default profile"
    yield document.origin("sh tests/bench/bench.sh tunables FOLDER", count)
    yield (f"{profile}, {rate} bits per pixel: {default[0]:.2f} dB on photographs, {default[1]:.2f} dB on drawings; standard deviations"
           f" over {len(profiles)} seeds {spreads[0]:.2f} and {spreads[1]:.2f} dB.\n")
    rows = []
    for name, expression in fields_of(room):
        found = {task[2]: result for task, result in results.items() if task[1] == name}
        rows.append([f"`{name}`", expression, *(cell(found[f], default) if f in found else "-" for f in FACTORS)])
    yield document.table(["tunable", "default", "half: photographs dB, drawings dB, time", "twice: the same"], rows)


def main():
    parser = codec.parser(__doc__)
    parser.add_argument("--drawings", help="names of drawings, separated by commas (default: all)")
    parser.add_argument("--rooms", help="separated by commas (default: all that have tunables)")
    parser.add_argument("--rate", type=float, default=0.125, help="bits per pixel (default %(default)s)")
    parser.add_argument("--jobs", type=int, default=2, help="encodes at a time (default %(default)s)")
    document.add_option(parser, "TUNABLES.md", "tunables-ROOM")
    arguments = parser.parse_args()
    rooms = arguments.rooms.split(",") if arguments.rooms else sorted(
        path.parent.name for path in (ROOT / "host/lib").glob("*/tunables.c"))
    sections = {room: document.Section(arguments.document, f"tunables-{room}") if arguments.document else None for room in rooms}
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        photographs, drawings = codec.images_of(arguments.folder, arguments.only), []
        for module, names in DRAWINGS.items():
            module.draw_all(folder / module.__name__)
            drawings += [folder / module.__name__ / f"{name}.png" for name in names
                         if not arguments.drawings or name in arguments.drawings.split(",")]
        images = photographs, drawings
        trees = queue.Queue()
        for job in range(arguments.jobs):
            (folder / str(job)).mkdir()
            trees.put(Tree(folder / str(job)))

        def run(task):
            room, name, _, new, seed = task
            tree = trees.get()
            try:
                gscl = tree.gscl(room, name, new)
                options = ["--profile", "paper", "--effort", str(PAPER_EFFORT)] if room == PAPER_ROOM else []
                return measure(gscl, images, arguments.rate, options, seed, tree.build) if gscl else None
            finally:
                trees.put(tree)

        for room, section in sections.items():
            profiles = [(room, "", 1, "", seed) for seed in SEEDS]
            run(profiles[0])  # kernels are compiled once
            tasks = profiles + [(*variant, SEEDS[0]) for variant in variants_of([room])]
            with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
                results = dict(zip(tasks, pool.map(run, tasks)))
            document.publish(section, *lines_of(room, profiles, results, len(photographs + drawings), arguments.rate))


if __name__ == "__main__":
    main()
