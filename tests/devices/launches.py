#!/usr/bin/env python3
"""Counts the launches of kernels and the waits of encodes in the GPU mapping: launches.py BUILD PICTURE [--effort N]

Each encode runs on the first OpenCL device, PoCL where no GPU is at hand, with count_launches.c loaded before it.  The launches,
their work-groups and the waits are those of any device: they follow from the picture, the settings and the mapping.  Prints a
table for each of CASES, with what launch_model.py makes of it.
"""
import argparse
import collections
import math
import os
import statistics
import subprocess
import sys
import tempfile

import launch_model

CASES = [("0.042", "psnr"), ("0.183", "psnr"), ("0.042", "visual"), ("0.183", "visual")]  # bits per pixel, tune
TIMEOUT = 3600  # seconds of one command
FEW_GROUPS = launch_model.MULTIPROCESSORS
VERY_FEW_GROUPS = 32  # fewer leave three quarters of the multiprocessors without work


class Log:
    """What count_launches.c wrote."""

    def __init__(self, path):
        self.groups = collections.defaultdict(list)  # kernel -> work-groups of each launch
        self.rounds = collections.defaultdict(list)  # kernel -> rounds, or boxes, of each launch (launch_model.py)
        self.sizes = {}  # kernel -> work-items of a group
        self.waits = collections.Counter()  # function -> calls that wait
        last = {}  # kernel -> work-groups of its last launch
        with open(path, encoding="ascii") as file:
            for line in file:
                what, name, *numbers = line.split()
                if what == "kernel":
                    self.groups[name].append(int(numbers[0]))
                    self.rounds[name].append(launch_model.rounds(name, last, *map(int, numbers[2:])))
                    last[name] = int(numbers[0])
                    if name in ("control_fit", "sum_loss"):
                        last.pop("begin_control", None)
                    self.sizes[name] = int(numbers[1])
                else:
                    self.waits[name] += 1

    @property
    def launches(self):
        return sum(map(len, self.groups.values()))

    def launches_below(self, groups):
        """Launches of fewer work-groups."""
        return sum(count < groups for counts in self.groups.values() for count in counts)

    def kernel_ms(self, kernel, below=math.inf):
        """(low, high) of the model, of launches of fewer work-groups than `below`."""
        launches = zip(self.groups[kernel], self.rounds[kernel])
        return launch_model.kernel_ms(kernel, [launch for launch in launches if launch[0] < below])

    def milliseconds(self, below=math.inf):
        """The same of all kernels."""
        return tuple(map(sum, zip(*(self.kernel_ms(kernel, below) for kernel in self.groups))))


def record(build, words):
    """The launches of gscl WORDS..., where {out} is a file that it may write."""
    with tempfile.TemporaryDirectory() as folder:
        log, out = os.path.join(folder, "log"), os.path.join(folder, "out")
        environment = os.environ | {"LD_PRELOAD": os.path.abspath(f"{build}/tests/devices/libcount_launches.so"),
                                    "COUNT_LAUNCHES": log, "POCL_SIGFPE_HANDLER": "0"}
        words = [word.replace("{out}", out) for word in words]
        subprocess.run([f"{build}/gscl", *words], check=True, env=environment, stdin=subprocess.DEVNULL,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=TIMEOUT)
        return Log(log)


def record_encode(build, picture, *options):
    return record(build, ["encode", picture, "-o", "{out}.gscl", "--quiet", "--device", "0.0", "--mapping", "gpu", *options])


def record_case(build, picture, bpp, tune, *options):
    return record_encode(build, picture, "--bpp", bpp, "--tune", tune, *options)


def row(cells):
    return "| " + " | ".join(map(str, cells)) + " |"


def kernel_rows(log):
    """A table of an encode, by launches."""
    yield row(["kernel", "work-items of a group", "launches", "groups: least", "mean", "most", "H100, ms: low", "high"])
    yield row(["---"] + ["---:"] * 7)
    for kernel, counts in sorted(log.groups.items(), key=lambda item: -len(item[1])):
        low, high = log.kernel_ms(kernel)
        yield row([kernel, log.sizes[kernel], len(counts), min(counts), round(statistics.mean(counts)), max(counts),
                   f"{low:.1f}", f"{high:.1f}"])


def case_rows(logs):
    """A table of all encodes, `logs`: {(bits per pixel, tune): Log}"""
    yield row(["bits per pixel", "tune", "launches", f"of fewer than {FEW_GROUPS} groups", "of one group", "waits",
               "kernels on an H100, ms", f"in launches of fewer than {VERY_FEW_GROUPS} groups, %", "waits, ms"])
    yield row(["---"] * 2 + ["---:"] * 7)
    for (bpp, tune), log in logs.items():
        waits = sum(log.waits.values())
        low, high = log.milliseconds()
        low_part, high_part = log.milliseconds(VERY_FEW_GROUPS)
        low_wait, high_wait = launch_model.waits_ms(waits)
        yield row([bpp, tune, log.launches, log.launches_below(FEW_GROUPS), log.launches_below(2), waits,
                   f"{low:.0f} to {high:.0f}", f"{100 * low_part / low:.0f} to {100 * high_part / high:.0f}",
                   f"{low_wait:.1f} to {high_wait:.1f}"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", metavar="BUILD")
    parser.add_argument("picture", metavar="PICTURE")
    parser.add_argument("--effort", default="5")
    options = parser.parse_args()
    logs = {case: record_case(options.build, options.picture, *case, "--effort", options.effort) for case in CASES}
    print("\n".join(case_rows(logs)))
    for (bpp, tune), log in logs.items():
        print(f"\n{bpp} bits per pixel, --tune {tune}; waits: {dict(log.waits)}\n", *kernel_rows(log), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
