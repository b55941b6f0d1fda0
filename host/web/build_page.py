#!/usr/bin/env python3
"""Joins the demonstration page to one file, which needs no server: build_page.py --package FOLDER --out FILE SOURCE...

The scripts and the style sheet of index.html, the decoder and, where the package in FOLDER has it, the encoder with its modules and the
script of its workers lie inside the page.  It needs esbuild.
"""
import argparse
import gzip
import pathlib
import re
import shutil
import subprocess
import tempfile

ESBUILD = "esbuild --bundle --minify --charset=utf8 --target=es2022 --log-level=warning".split()
LOADERS = "--loader:.gz=binary --loader:.wasm=binary --loader:.txt=text".split()
MODULES = ["gscl-encode.wasm", "gscl-encode-alpha.wasm"]
SCRIPTS = ["encode.js", "encode-run.js", "encode-worker.js"]


def copy_package(package, folder):
    """Copies what the scripts of the page import; returns whether there is an encoder."""
    for name in ["gscl.js", "gscl.wasm", "gpu.js", "splats.js", "tiny.js"]:
        shutil.copy(package / name, folder)
    if not all((package / name).exists() for name in MODULES + SCRIPTS):
        return False
    for name in SCRIPTS:
        shutil.copy(package / name, folder)
    for name in MODULES:
        (folder / f"{name}.gz").write_bytes(gzip.compress((package / name).read_bytes(), 9, mtime=0))
    subprocess.run([*ESBUILD, "--format=iife", str(folder / "encode-worker.js"), f"--outfile={folder / 'worker.txt'}"], check=True)
    return True


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--package", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("sources", nargs="+", type=pathlib.Path)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        demo = folder / "demo"
        demo.mkdir()
        for source in options.sources:
            shutil.copy(source, demo)
        if not copy_package(options.package, folder):
            shutil.copy(demo / "without_encoder.js", demo / "encoder.js")
        subprocess.run([*ESBUILD, *LOADERS, "--format=esm", str(demo / "demo.js"), f"--outfile={demo / 'page.js'}"], check=True)
        script, style = (demo / "page.js").read_text(), (demo / "demo.css").read_text()
        page = (demo / "index.html").read_text()
    page = re.sub('<link rel="stylesheet".*>', lambda _: f"<style>\n{style}</style>", page)
    options.out.write_text(re.sub('<script type="module".*>', lambda _: f'<script type="module">{script}</script>', page))


if __name__ == "__main__":
    main()
