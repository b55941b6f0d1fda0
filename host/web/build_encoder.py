#!/usr/bin/env python3
"""Builds the encoder for web pages and Node: build_encoder.py --out FOLDER --depfile FILE --clang CLANG --linker WASM_LD
        [--library FILE...] [--include FOLDER...] C_SOURCE...

Writes gscl-encode.wasm, for opaque pictures, and gscl-encode-alpha.wasm, for others, into the folder: the library's sources
with the kernels that encodes with the default profile need.  Their memory is imported, and shared; a module with one bit less serves
where none can be shared (encoder/encode.js).  It needs clang and wasm-ld of the same version, 16 or newer, the headers of wasi-libc, and
wasm-opt, wasm-dis and wasm-as; the libraries are its libc and clang's run-time library for wasm32.  compile_commands_encoder.json is for clang-tidy.
"""
import argparse
import pathlib
import re
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

import build

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "cl"))
import native  # noqa: E402
from programs import programs  # noqa: E402

PROCESSOR = "wasm32"
# The module has no other blend and loss, and one splat in a vector of the fit: sixteen are a tenth of the time and 22 kB gzipped.
FIXED = ["-DBLEND=GSCL_NORMALIZED", "-DLOSS=GSCL_LOSS_KIND_L2"]
LANES = ["-DGSCL_CPU_SPLAT_LANES=1"]
# WebAssembly has no fused multiply-add: files are those of x86-64-v2.
KERNELS = ["--target=wasm32", *build.FEATURES, *FIXED, *LANES, "-DSOFTWARE_FMA", "-fno-PIC", "-Wno-pass-failed"]
# Thread-local variables are ordinary ones: wasm_pool.c says why.
HOST = ["--target=wasm32-wasi", *build.HOST, *LANES, "-DGSCL_WITH_NATIVE", "-matomics", "-D__thread="]
STACK_BYTES = 1 << 20
# Memory is that of encode-run.js, which gives it this size.  libc's objects have no atomic operations and need none: one thread alone calls
# them.  Exported functions would run destructors, also those of threads, if nothing named the constructors, of which there are none.
INITIAL_BYTES, MAX_BYTES = 4 << 20, 1 << 32
MEMORY = ["--import-memory", "--shared-memory", "--no-check-features", f"--initial-memory={INITIAL_BYTES}", f"--max-memory={MAX_BYTES}",
          "--export=__stack_pointer", "--export=__wasm_call_ctors"]
# Most of the time passes in the fit: -Os there is a tenth of the time for 0.5 kB, -O2 not faster and 4 kB more.
SIZE, SPEED, FAST_KINDS = "-Oz", "-Os", {"FIT"}
KINDS = {"RENDER", "BIN", "FIT", "SCALAR_RDO", "VISUAL", "IMAGE"}
# Modules and the channels of their kernels: colours, and whether there is alpha.  Faint colours are tried as grey.
MODULES = {"gscl-encode.wasm": {(1, 0), (3, 0)}, "gscl-encode-alpha.wasm": {(1, 1), (3, 1)}}
FEATURES = [*build.WASM_FEATURES, *"--enable-threads --enable-mutable-globals".split()]
OPTIMISE = ["wasm-opt", *FEATURES, *build.MEMORY_USE, "-Oz", "--flatten", "--rereloop", "-Oz", "-Oz"]


def chosen(channels):
    """General programs alone: specialised ones would double the module for a tenth of the time."""
    return [program for program in sorted(programs(), key=lambda program: program.kind)
            if program.kind in KINDS and not program.options
            and (not program.colours or (program.colours, program.alpha_channel) in channels)]


def compile_kernels(program, clang, folder):
    target = folder / f"{program.name}.o"
    native.compile_program(program, PROCESSOR, target, [clang, *KERNELS, SPEED if program.kind in FAST_KINDS else SIZE])
    return target


def compiler(source, clang, includes):
    return [clang, *HOST, SIZE, *(f"-I{include}" for include in includes), "-c", str(source)]


def compile_host(source, clang, includes, folder):
    target = folder / (str(source).strip("/").replace("/", "_").replace("..", "") + ".o")
    build.run([*compiler(source, clang, includes), "-MD", "-MF", f"{target}.d", "-o", str(target)])
    return target


def pair_functions(module):
    """Moves functions of the same name, which programs for different channels have, next to each other: most are alike, and what
    is alike within 32 kB takes gzip little.  The module has 3.3 kB less of 147."""
    text = module.with_suffix(".wat")
    build.run(["wasm-dis", *FEATURES, str(module), "-o", str(text)])
    start, *functions = text.read_text().rstrip().removesuffix(")").split("\n (func ")
    groups = {}
    for function in functions:
        name = re.sub(r"\.\d+$", "", function.split()[0])  # the same name in another program, which wasm-dis numbers
        groups.setdefault(re.sub(r"_[13][01]_", "_", name), []).append(function)
    text.write_text("\n (func ".join([start, *(function for group in groups.values() for function in group)]) + ")\n")
    build.run(["wasm-as", *FEATURES, str(text), "-o", str(module)])


def link(name, kernels, host, options, folder):
    """`kernels`: the object of each program."""
    programs_of = chosen(MODULES[name])
    table = folder / f"table_of_{name}.c"
    native.write_table(table, options.clang, [PROCESSOR], programs_of)
    objects = [*(kernels[program] for program in programs_of), *host, compile_host(table, options.clang, options.include, folder)]
    build.run([options.linker, *build.LINKING, "--strip-debug", *MEMORY, "-z", f"stack-size={STACK_BYTES}", *build.SMALLER, *build.PASSES, *map(str, objects),
               *options.library, "-o", str(folder / name)])
    pair_functions(folder / name)
    build.run([*OPTIMISE, str(folder / name), "-o", str(options.out / name)])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--depfile", type=pathlib.Path, required=True)
    parser.add_argument("--clang", required=True)
    parser.add_argument("--linker", required=True)
    parser.add_argument("--library", action="append", default=[])
    parser.add_argument("--include", action="append", default=[])
    parser.add_argument("sources", nargs="+", type=pathlib.Path)
    options = parser.parse_args()
    build.write_commands(options.sources, lambda source: compiler(source, options.clang, options.include),
                         options.out / "compile_commands_encoder.json")
    with tempfile.TemporaryDirectory() as name, ThreadPoolExecutor() as pool:
        folder = pathlib.Path(name)
        needed = {program for channels in MODULES.values() for program in chosen(channels)}
        kernels = {program: pool.submit(compile_kernels, program, options.clang, folder) for program in needed}
        host = list(pool.map(lambda source: compile_host(source, options.clang, options.include, folder), options.sources))
        kernels = {program: task.result() for program, task in kernels.items()}
        list(pool.map(lambda module: link(module, kernels, host, options, folder), MODULES))
        options.depfile.write_text(f"{' '.join(MODULES)}: {' '.join(build.headers(host))}\n")


if __name__ == "__main__":
    main()
