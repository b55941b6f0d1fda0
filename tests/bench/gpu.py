#!/usr/bin/env python3
"""What the kernels take on GPUs, and how many launches encodes make: gpu.py BUILD PICTURE [--document [FILE]]

BUILD was configured with -Dtests=enabled.  The kernels of the GPU mapping are compiled for the targets of tests/targets, those of
NVIDIA with ptxas, which is installed in BUILD; encodes of PICTURE on PoCL count the launches (tests/devices/launches.py).  No GPU
is needed.  It takes a quarter of an hour on two cores.  Without --document it prints the section that it writes in GPU.md.
"""
import argparse
import concurrent.futures
import os
import pathlib
import sys
import tempfile

import document

TESTS = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "targets"), str(TESTS / "devices")]

import check_targets
import compilers
import launches
import occupancy
import programs
import ptxas

CONFORMANCE = TESTS / "conformance/files"
NVIDIA = {"sm_90": ["registers", "stack", "spilled", "shared"], "sm_75": ["registers", "stack", "spilled", "shared"]}
AMD = {"gfx90a": ["VGPRs", "SGPRs", "scratch", "spilled", "LDS", "waves"],
       "gfx1100": ["VGPRs", "SGPRs", "scratch", "spilled", "LDS", "waves"]}
# Encodes of a small picture that launch, with CASES, all kernels but those of measuring.
FURTHER = [["--tune", "ssim"], ["--profile", "paper"], ["--profile", "paper", "--loss", "l1+ssim"], ["--blend", "alpha"]]


# ---- Kernels --------------------------------------------------------------------------------------


def compiled(build):
    """[(program, {kernel: {device: {column: number}}})] of the programs of encodes, and of those with most options."""
    assembler = ptxas.install(f"{build}/tests/targets/venv")
    if not assembler:
        raise SystemExit("ptxas cannot be installed: see tests/targets/requirements.txt")
    listed = [program for program in programs.read(f"{build}/tests/targets/list_programs")
              if program.mapping == "gpu" and program.set != "other" and program.kind != "accuracy"]
    todo = [(program, target) for program in listed for target in compilers.targets(assembler)]
    with concurrent.futures.ThreadPoolExecutor(check_targets.PROCESSES) as pool:
        kernels = list(pool.map(lambda of: check_targets.compile_program(*of, True), todo))
    return [(program, found) for (program, _), found in zip(todo, kernels)]


def encode_rows(results):
    """{(program, kernel): {device: figures}} of an ordinary encode."""
    rows = {}
    for program, kernels in results:
        if program.set == "encode":
            for kernel, devices in kernels.items():
                rows.setdefault((program.kind + program.use.removeprefix("encode"), kernel), {}).update(devices)
    return rows


def largest_rows(results):
    """The largest figure of each kernel; waves are the fewest."""
    rows = {}
    for program, kernels in results:
        for kernel, devices in kernels.items():
            for device, figures in devices.items():
                largest = rows.setdefault((program.kind, kernel), {}).setdefault(device, {})
                for column, number in figures.items():
                    choose = min if column == "waves" else max
                    largest[column] = choose(number, largest.get(column, number))
    return dict(sorted(rows.items()))


def nvidia_table(rows, sizes):
    """`sizes`: {kernel: work-items of a group}"""
    yield launches.row(["program", "kernel", "group"] + [f"{device} {column}" for device, columns in NVIDIA.items()
                                                         for column in [*columns, "occupancy"]])
    yield launches.row(["---"] * 2 + ["---:"] * (1 + sum(len(columns) + 1 for columns in NVIDIA.values())))
    for (program, kernel), devices in rows.items():
        cells = [program, kernel, sizes.get(kernel, "")]
        for device, columns in NVIDIA.items():
            cells += [devices[device][column] for column in columns]
            cells.append(f"{100 * occupancy.occupancy(device, devices[device], sizes[kernel]):.0f} %" if kernel in sizes else "")
        yield launches.row(cells)


def amd_table(rows):
    columns = [(device, column) for device, names in AMD.items() for column in names]
    yield launches.row(["program", "kernel"] + [f"{device} {column}" for device, column in columns])
    yield launches.row(["---"] * 2 + ["---:"] * len(columns))
    for (program, kernel), devices in rows.items():
        yield launches.row([program, kernel] + [devices[device][column] for device, column in columns])


# ---- Launches -------------------------------------------------------------------------------------


def group_sizes(build, logs):
    """{kernel: work-items of a group}, from CASES and the encodes of FURTHER."""
    sizes = {}
    for log in logs:
        sizes |= log.sizes
    with tempfile.TemporaryDirectory() as folder:
        picture = os.path.join(folder, "picture.png")
        launches.record(build, ["decode", str(CONFORMANCE / "photograph.gscl"), "-o", picture, "--scale", "4", "--device", "host"])
        for words in FURTHER:
            sizes |= launches.record_encode(build, picture, "--splats", "200", "--effort", "1", *words).sizes
    return sizes


def section(results, logs, sizes, picture):
    """Lines of the document."""
    for title, rows in (("An encode with the default settings and a decode", encode_rows(results)),
                        ("The largest figures over programs with most and with least options", largest_rows(results))):
        yield from ["", f"## {title}", "", *nvidia_table(rows, sizes), "", *amd_table(rows)]
    yield from ["", f"## Launches of encodes of {picture}", "", *launches.case_rows(logs)]
    for (bpp, tune), log in logs.items():
        waits = ", ".join(f"{count} of {name}" for name, count in log.waits.most_common())
        yield from ["", f"### {bpp} bits per pixel, `--tune {tune}`", "", f"Waits: {waits}.", "", *launches.kernel_rows(log)]
    yield ""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", metavar="BUILD")
    parser.add_argument("picture", metavar="PICTURE")
    document.add_option(parser, "GPU.md", "gpu")
    options = parser.parse_args()
    place = document.section_of(options)
    logs = {case: launches.record_case(options.build, options.picture, *case) for case in launches.CASES}
    sizes = group_sizes(options.build, logs.values())
    document.publish(place, *section(compiled(options.build), logs, sizes, pathlib.Path(options.picture).name))


if __name__ == "__main__":
    main()
