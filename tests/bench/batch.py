"""A run over many small images that is killed several times, and what it costs:

    python3 tests/bench/batch.py GSCL [--images 5000] [--kills 5] [--jobs 2]

The images are random scenes of 64x48 pixels, one in a hundred of them damaged: empty, cut, text, or missing.  The command
runs until it is killed by SIGKILL at random times, and then to its end.  Afterwards each image must have one line in the
report, each good one an output that decodes, none may have been encoded twice, and no temporary file may be left."""
import argparse
import json
import os
import pathlib
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "cli"))
from images import Image, png_bytes

WIDTH, HEIGHT = 64, 48
SOME_FAILED = 3


def rectangles(rng):
    """A PNG of a few random rectangles."""
    rows = [bytearray(bytes(rng.randrange(256) for _ in range(3)) * WIDTH) for _ in range(HEIGHT)]
    for _ in range(4):
        x, y, colour = rng.randrange(WIDTH - 8), rng.randrange(HEIGHT - 8), bytes(rng.randrange(256) for _ in range(3))
        width, height = rng.randrange(4, WIDTH - x), rng.randrange(4, HEIGHT - y)
        for row in rows[y:y + height]:
            row[3 * x:3 * (x + width)] = colour * width
    return png_bytes(Image(WIDTH, HEIGHT, 3, 8, [sample for row in rows for sample in row]))


def make_images(folder, count, rng):
    """Writes the images and their list; returns the names of the good and of the bad ones."""
    bad = set(rng.sample(range(count), count // 100))
    names = [f"in/{i % 100:02}/{i:06}.png" for i in range(count)]
    for i, name in enumerate(names):
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        data = rectangles(rng)
        if i not in bad:
            path.write_bytes(data)
        elif i % 4 != 3:  # else it is missing
            path.write_bytes((b"", data[:len(data) // 2], b"no image\n")[i % 4])
    (folder / "list").write_text("".join(name + "\n" for name in names))
    return [name for i, name in enumerate(names) if i not in bad], [names[i] for i in sorted(bad)]


def lines_of(report):
    return report.read_bytes().count(b"\n") if report.exists() else 0


def run_until_killed(command, folder, more_lines):
    """Kills the run when it has written so many more lines; returns its seconds, and False where it ended before."""
    report, begin = folder / "report", time.monotonic()
    target = lines_of(report) + more_lines
    process = subprocess.Popen(command, cwd=folder, stderr=subprocess.DEVNULL)
    while process.poll() is None and lines_of(report) < target:
        time.sleep(0.01)
    killed = process.poll() is None
    process.send_signal(signal.SIGKILL)
    process.wait()
    return time.monotonic() - begin, killed


def output_of(folder, name):
    return folder / "out" / (name[:-4] + ".gscl")


def check(gscl, folder, good, bad):
    lines = [json.loads(line) for line in (folder / "report").read_text().splitlines()]
    states = {line["input"]: line["status"] for line in lines}
    assert len(lines) == len(states) == len(good) + len(bad), "an image has no line, or more than one"
    assert all(states[name] in ("ok", "skipped") for name in good), "a good image failed"
    assert all(states[name] == "failed" for name in bad), "a bad image did not fail"
    for line in lines:
        if line["status"] != "failed":
            assert output_of(folder, line["input"]).stat().st_size == line["bytes"] or line["bytes"] is None
    for name in good:
        subprocess.run([gscl, "info", output_of(folder, name)], check=True, stdout=subprocess.DEVNULL)
    outputs = [path for path in (folder / "out").rglob("*") if path.is_file()]
    assert len(outputs) == len(good), "a file is left or missing"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("gscl", type=os.path.abspath)
    parser.add_argument("--images", type=int, default=5000)
    parser.add_argument("--kills", type=int, default=5)
    parser.add_argument("--jobs", default="2")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    rng = random.Random(options.seed)
    with tempfile.TemporaryDirectory(prefix="gscl-batch-") as name:
        folder = pathlib.Path(name)
        good, bad = make_images(folder, options.images, rng)
        command = [options.gscl, "encode", "--files-from", "list", "--out-dir", "out", "--keep-tree", "--skip-existing", "--jsonl",
                   "report", "--jobs", options.jobs, "--effort", "0", "--bytes", "120", "--quiet"]
        seconds, kills, times = 0, 0, {}
        for _ in range(options.kills):
            part, killed = run_until_killed(command, folder, rng.randrange(1, 2 * options.images // (options.kills + 2)))
            seconds, kills = seconds + part, kills + killed
            for path in (folder / "out").rglob("[!.]*.gscl"):
                assert times.setdefault(path, path.stat().st_mtime_ns) == path.stat().st_mtime_ns, "encoded twice"
        begin = time.monotonic()
        last = subprocess.run(command, cwd=folder, stderr=subprocess.PIPE, check=False)
        seconds += time.monotonic() - begin
        assert last.returncode == (SOME_FAILED if bad else 0), last.stderr.decode()
        for path, then in times.items():
            assert path.stat().st_mtime_ns == then, "encoded twice"
        peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
        check(options.gscl, folder, good, bad)
        print(f"{options.images} images, {len(bad)} of them bad, {kills} kills, {options.jobs} jobs: {seconds:.1f} s, "
              f"{options.images / seconds:.1f} images/s, at most {peak:.0f} MiB; nothing lost, none encoded twice")
        print(last.stderr.decode().splitlines()[-1])


if __name__ == "__main__":
    sys.exit(main())
