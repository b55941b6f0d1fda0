#!/usr/bin/env python3
"""Builds the decoder for web pages: build.py --out FOLDER --depfile FILE [--include FOLDER...] C_SOURCE... JS_SOURCE...

Writes gscl.wasm and gscl-packets.wasm, compiled from the C sources without and with the code for packets, gscl.js, which
joins JavaScript sources, inline.js, which has gscl.wasm in it, and tiny.js into the folder, and compile_commands.json
for clang-tidy and editors.  It needs clang and wasm-ld of the same version, wasm-opt and esbuild.
"""
import argparse
import base64
import json
import pathlib
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

# Of WebAssembly, as clang and as wasm-opt name them.  All modules are compiled for these.
FEATURES = "-msimd128 -mbulk-memory -mnontrapping-fptoint -msign-ext".split()
WASM_FEATURES = "--enable-simd --enable-bulk-memory --enable-nontrapping-float-to-int --enable-sign-ext".split()
MEMORY_USE = ["--low-memory-unused"]  # the lowest 1024 bytes hold nothing, where wasm-ld begins the data
# Of all C sources.
HOST = """-std=c99 -flto -DNDEBUG -ffp-contract=off -fno-math-errno -fvisibility=hidden -ffunction-sections -fdata-sections
    -fno-slp-vectorize""".split() + FEATURES
COMPILE = ["clang", "--target=wasm32", "-DGSF_SMALL_READER", "-nostdlibinc", *HOST]
# Modules and the arguments that only they are compiled with.
MODULES = {"gscl.wasm": ["-DGSF_WITHOUT_PACKETS"], "gscl-packets.wasm": []}
# Of LLVM, in compiling and in linking: only what makes code smaller is inlined, and equal ends of branches are not joined.
PASSES = "-mllvm -inline-threshold=0 -mllvm -simplifycfg-sink-common=0".split()
# In linking besides.
SMALLER = "-mllvm -disable-lsr -mllvm -enable-pre=0".split()
# Found by trying, as the order of the passes below.
LINK_PASSES = "-mllvm -two-entry-phi-node-folding-threshold=1 -mllvm -bonus-inst-threshold=2 -mllvm -inline-threshold=10".split()
# Only the loops of the canvas, which take most of the time, are worth more than the smallest code.
SIZE, VECTORS = "-Oz", "-Os"
FAST = {"canvas.c"}
LINKING = "--no-entry --gc-sections".split()
LINK = ["wasm-ld", *LINKING, "--strip-all", "-z", "stack-size=65536", *SMALLER, *PASSES, *LINK_PASSES]
# The order of the passes was found by trying.
OPTIMISE = ["wasm-opt", *WASM_FEATURES, *MEMORY_USE] + """--optimize-added-constants-propagate --flatten --rereloop --remove-unused-brs --reorder-functions
    --precompute-propagate --rse --dealign --merge-blocks --reorder-locals --coalesce-locals --local-cse --dae-optimizing -Oz -Oz
    --ssa-nomerge --flatten --rse -Oz""".split()

MINIFY = "esbuild --minify --target=es2022 --log-level=warning".split()


def run(command):
    """Stops at an error; prints what the program says only then, or where it is a warning of the compiler."""
    done = subprocess.run(command, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0 or command[0] == "clang":
        sys.stderr.write(done.stderr)
    if done.returncode != 0:
        sys.exit(done.returncode)


def compiler(source, includes):
    return [*COMPILE, *PASSES, VECTORS if source.name in FAST else SIZE, *(f"-I{include}" for include in includes), "-c", str(source)]


def compile_source(source, includes, own, folder):
    target = folder / (str(source).strip("/").replace("/", "_") + ".o")
    run([*compiler(source, includes), *own, "-MD", "-MF", f"{target}.d", "-o", str(target)])
    return target


def write_commands(sources, command_of, target):
    folder = pathlib.Path.cwd()
    commands = [{"directory": str(folder), "file": str(source), "arguments": command_of(source)} for source in sources]
    target.write_text(json.dumps(commands))


def headers(objects):
    """Headers that the sources include, from the files that clang writes."""
    words = " ".join(pathlib.Path(f"{path}.d").read_text().replace("\\\n", " ").split(":", 1)[1] for path in objects).split()
    return sorted({word for word in words if word.endswith(".h")})


def build_module(sources, includes, target):
    """Returns the headers that the module was made of."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        with ThreadPoolExecutor(2) as pool:
            objects = list(pool.map(lambda source: compile_source(source, includes, MODULES[target.name], folder), sources))
        run([*LINK, *map(str, objects), "-o", str(folder / "linked.wasm")])
        run([*OPTIMISE, str(folder / "linked.wasm"), "-o", str(target)])
        return headers(objects)


def joined(sources, names):
    """JavaScript sources as one, with `let`, which is shorter than `const` and nearly everywhere."""
    return re.sub(r"\bconst ", "let ", "".join(sources[name].read_text() for name in names))


def build_script(sources, names, target):
    minified = subprocess.run(MINIFY, input=joined(sources, names), check=True, stdout=subprocess.PIPE, text=True)
    target.write_text(minified.stdout)


def build_inline_script(sources, module, target):
    text = base64.b64encode(module.read_bytes()).decode()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "gscl.js").write_text(f"const MODULE = '{text}';" + joined(sources, ["decoder.js", "inline_module.js", "element.js"]))
        for entry in ["splats.js", "inline.js", "tiny.js"]:
            (folder / entry).write_text(sources[entry].read_text())
        run([*MINIFY, "--bundle", "--format=esm", f"--outfile={target}", str(folder / "inline.js")])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--depfile", type=pathlib.Path, required=True)
    parser.add_argument("--include", action="append", default=[])
    parser.add_argument("sources", nargs="+", type=pathlib.Path)
    options = parser.parse_args()
    c_sources = [path for path in options.sources if path.suffix == ".c"]
    included = {header for name in MODULES for header in build_module(c_sources, options.include, options.out / name)}
    write_commands(c_sources, lambda source: compiler(source, options.include), options.out / "compile_commands.json")
    scripts = {path.name: path for path in options.sources if path.suffix == ".js"}
    build_script(scripts, ["decoder.js", "module.js", "element.js"], options.out / "gscl.js")
    build_script(scripts, ["tiny.js"], options.out / "tiny.js")
    build_inline_script(scripts, options.out / "gscl.wasm", options.out / "inline.js")
    options.depfile.write_text(f"{' '.join(MODULES)} gscl.js inline.js tiny.js: {' '.join(sorted(included))}\n")


if __name__ == "__main__":
    main()
