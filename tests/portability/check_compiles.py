#!/usr/bin/env python3
"""Compiles the library's C sources, and those of the room of the operating system, for systems of which this machine has no
linker and no emulator: check_compiles.py BUILD [TARGET...]

BUILD: a build folder with the tool, whose compile_commands.json names the sources.  TARGET is one of zig's (default: macOS and
FreeBSD).  The compiler is the package ziglang of PyPI, installed in build-portability/zig.  OpenCL, for whose headers there is no
such package, is left out.  Prints a line for each target; ends with status 1 where a source does not compile or has a warning.
"""
import json
import pathlib
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

ROOT = pathlib.Path(__file__).resolve().parents[2]
TARGETS = ["aarch64-macos", "x86_64-macos", "aarch64-freebsd", "x86_64-freebsd"]
OTHER_SYSTEMS = ("_linux.c", "_windows.c", "windows_names.c")


def installed_python():
    """Python of an environment with ziglang."""
    python = ROOT / "build-portability/zig/bin/python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", str(python.parents[1])], check=True)
        subprocess.run([str(python), "-m", "pip", "install", "--quiet", "ziglang"], check=True)
    return str(python)


def sources(build):
    """{source: its definitions and folders of headers}"""
    found = {}
    for command in json.loads((build / "compile_commands.json").read_text()):
        source = (build / command["file"]).resolve()
        is_wanted = "libgscl.so" in command["output"] or source.parent == ROOT / "host/system"
        if is_wanted and source.suffix == ".c" and source.is_relative_to(ROOT) and "opencl" not in source.parts:
            words = shlex.split(command["command"])
            found[source] = [word for word in words if word[:2] in ("-I", "-D") and not word.startswith(("-DGSCL_WITH_OPENCL", "-D_FORTIFY_SOURCE"))]
    options = next(iter(found.values()))
    found = {source: own for source, own in found.items() if not source.name.endswith(OTHER_SYSTEMS) and not source.is_relative_to(build)}
    return {**found, ROOT / "host/system/machine_posix.c": options}


def main():
    build, targets = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2:] or TARGETS
    python, all_sources = installed_python(), sources(build)
    failed = False
    for target in targets:
        compiler = [python, "-m", "ziglang", "cc", "-target", target, "-std=c99", "-Wall", "-Wextra", "-Werror", "-c", "-o", "/dev/null"]
        with ThreadPoolExecutor() as pool:
            runs = list(pool.map(lambda item: subprocess.run([*compiler, *item[1], str(item[0])], cwd=build, capture_output=True, text=True),
                                 all_sources.items()))
        errors = [run.stderr.splitlines()[0] for run in runs if run.returncode != 0]
        print(f"{target}: {len(runs) - len(errors)} of {len(runs)} sources compile", *errors, sep="\n    ")
        failed = failed or bool(errors)
    sys.exit(failed)


if __name__ == "__main__":
    main()
