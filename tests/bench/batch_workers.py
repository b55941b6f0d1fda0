"""Throughput of gscl.batch at 1, 2 and 4 workers, and what the scheduler costs a picture:

    build/python/venv/bin/python tests/bench/batch_workers.py [--images 400] [--empty 20000] [--workers 1,2,4] [--repeats 2]

The images are random scenes of 64x48 pixels at effort 0, encoded by worker processes with one encoder each.  The runs for
each number of workers alternate; the fastest of each counts.  Then the encoder is replaced by one that returns at once:
the time is that of the scheduler, of reading the image, of writing the output and the report; and, without images, that of
starting a cluster.  Prints processor seconds, too, which other work on the machine changes less than times."""
import argparse
import pathlib
import random
import resource
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "cli")]

from batch import rectangles


class Nothing:
    """In place of an encoder: the same file for each picture."""

    def __init__(self, encoded):
        self.encoded = encoded

    def __call__(self, picture, *, device, **settings):
        return self.encoded


def processor_seconds():
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def timed_run(pictures, folder, workers, **options):
    """(seconds, processor seconds) of a run, the start of its cluster included."""
    import gscl.batch
    out = tempfile.mkdtemp(dir=folder)
    begin, used = time.monotonic(), processor_seconds()
    summary = gscl.batch.run(pictures, out + "/out", out + "/report", workers=workers, encoders=1, root=str(folder), **options)
    assert summary.failed == 0, summary
    return time.monotonic() - begin, processor_seconds() - used


def write_images(folder, count):
    rng = random.Random(1)
    names = []
    for i in range(count):
        path = folder / f"in/{i % 100:02}/{i:06}.png"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(rectangles(rng))
        names.append(str(path))
    return names


def measure_throughput(names, folder, options):
    best = {workers: (float("inf"), 0) for workers in options.workers}
    empty = dict(best)
    for _ in range(options.repeats):
        for workers in options.workers:
            empty[workers] = min(empty[workers], timed_run(names[:workers], folder, workers, effort=0, bytes=120))
            best[workers] = min(best[workers], timed_run(names, folder, workers, effort=0, bytes=120))
    for workers, (seconds, used) in best.items():
        start, start_used = empty[workers]
        count = len(names) - workers
        print(f"{workers} workers: {count / (seconds - start):.1f} pictures/s, {1e3 * (used - start_used) / count:.1f} ms of "
              f"processor a picture; start of the cluster and of the encoders {start:.1f} s")


def measure_scheduler(names, folder, options):
    """The same images again and again, under names of their own."""
    import gscl
    links = folder / "links"
    links.mkdir()
    many = []
    for i in range(options.empty):
        link = links / f"{i:07}.png"
        link.symlink_to(names[i % len(names)])
        many.append(str(link))
    encoder = Nothing(gscl.encode(names[0], effort=0, bytes=120))
    for workers in options.workers:
        start, start_used = timed_run(many[:workers], folder, workers, encoder=encoder)
        seconds, used = timed_run(many, folder, workers, encoder=encoder)
        count = len(many) - workers
        print(f"{workers} workers without encoding: {1e3 * (seconds - start) / count:.2f} ms and "
              f"{1e3 * (used - start_used) / count:.2f} ms of processor a picture")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--images", type=int, default=400)
    parser.add_argument("--empty", type=int, default=20000)
    parser.add_argument("--workers", type=lambda text: [int(word) for word in text.split(",")], default=[1, 2, 4])
    parser.add_argument("--repeats", type=int, default=2)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="gscl-workers-") as name:
        folder = pathlib.Path(name)
        names = write_images(folder, options.images)
        measure_throughput(names, folder, options)
        measure_scheduler(names, folder, options)


if __name__ == "__main__":
    main()
