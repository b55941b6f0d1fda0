#!/usr/bin/env python3
"""Runs a test with the kernels that other tests compiled: with_cache.py FOLDER COMMAND...

PoCL keeps compiled kernels in the folder POCL_CACHE_DIR, which has no lock: each test has one of its own.  Before the
command, the files in FOLDER are linked into it; after the command, its new ones into FOLDER.  As a link appears whole or not
at all, tests may run at the same time.
"""
import os
import pathlib
import subprocess
import sys

COMPILED = {".bc", ".so"}
# Settings that change a kernel, but not the name of its file.
COMPILER_SETTINGS = {"POCL_WORK_GROUP_METHOD", "POCL_EXTRA_BUILD_FLAGS"}


def link_files(source, target):
    for path in sorted(source.rglob("*")):
        link = target / path.relative_to(source)
        if path.suffix in COMPILED and path.is_file() and not link.exists():
            link.parent.mkdir(parents=True, exist_ok=True)
            try:
                os.link(path, link)
            except FileExistsError:
                pass  # by a test that ended just now


def main():
    shared, command = pathlib.Path(sys.argv[1]), sys.argv[2:]
    own = os.environ.get("POCL_CACHE_DIR")
    if own is None or COMPILER_SETTINGS & os.environ.keys():
        os.execvp(command[0], command)
    shared.mkdir(parents=True, exist_ok=True)
    link_files(shared, pathlib.Path(own))
    code = subprocess.run(command).returncode
    if code == 0:
        link_files(pathlib.Path(own), shared)
    return code if code >= 0 else 128 - code


if __name__ == "__main__":
    sys.exit(main())
