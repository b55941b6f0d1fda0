#!/usr/bin/env python3
"""Compiles the kernels of cl/native.py for processors that no build here is for, and links them.

check_native.py [--quick]

A check is one program and target.  It fails where the compiler does, and where a symbol is undefined beside those that a
library has.  x86-64 and aarch64 are linked by builds of the library; --quick takes the programs that serve all effects in
images with four channels, and those that depend on no effect.  Needs Debian's clang and lld.
"""
import os
import pathlib
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

ROOT = pathlib.Path(__file__).resolve().parents[2]
NATIVE = ROOT / "cl" / "native.py"
# What the library or the compiler's own library gives to kernels.
STUBS = """
const void *gscl_launch_options(void) { return 0; }
void *memcpy(void *to, const void *from, __SIZE_TYPE__ size) { return to; }
void *memset(void *to, int value, __SIZE_TYPE__ size) { return to; }
"""
# Of 64-bit integers on processors of 32 bits: names of compiler-rt and libgcc.
RUNTIME = "".join(f"void {name}(void) {{}}\n" for name in [
    "__aeabi_uldivmod", "__aeabi_ldivmod", "__aeabi_f2ulz", "__aeabi_ul2f", "__aeabi_f2lz", "__aeabi_l2f", "__aeabi_idivmod",
    "__aeabi_uidivmod", "__aeabi_idiv", "__aeabi_uidiv", "__aeabi_memcpy", "__aeabi_memset", "__aeabi_memclr",
    "__aeabi_memcpy4", "__aeabi_memcpy8", "__aeabi_memset4", "__aeabi_memset8", "__aeabi_memclr4", "__aeabi_memclr8",
    "ceilf", "floorf", "rintf", "fmaf"])
# Names, with clang's options and the linker's.
TARGETS = {
    "rv64gc": (["--target=riscv64-linux-gnu", "-march=rv64gc", "-mabi=lp64d"], ["ld.lld", "-shared", "-z", "defs"], RUNTIME),
    "armv7": (["--target=arm-linux-gnueabihf", "-march=armv7-a", "-mfpu=neon-vfpv4", "-mfloat-abi=hard"],
              ["ld.lld", "-shared", "-z", "defs"], RUNTIME),
    "wasm32": (["--target=wasm32", "-msimd128", "-DSOFTWARE_FMA"], ["wasm-ld", "--no-entry", "--export-all"], ""),
}


def run(command, **arguments):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, **arguments)


def check(folder, target, program):
    """Why a program does not link; None where it does."""
    options, linker, runtime = TARGETS[target]
    stubs, built = folder / f"{target}.o", folder / f"{target}_{program}.o"
    if not stubs.exists():
        run(["clang", *options, "-ffreestanding", "-fno-builtin", "-w", "-fPIC", "-x", "c", "-c", "-", "-o", str(stubs)],
            input=STUBS + runtime)
    compiled = run([str(NATIVE), "compile", program, target, str(built), "clang", *options])
    if compiled.returncode != 0:
        return compiled.stdout
    linked = run([*linker, str(built), str(stubs), "-o", os.devnull])
    return None if linked.returncode == 0 else linked.stdout


def main(arguments):
    names = run([str(NATIVE), "names"]).stdout.split()
    if "--quick" in arguments:
        names = [name for name in names if "_31" in name or "_" not in name]
    checks = [(target, name) for target in TARGETS for name in names]
    with tempfile.TemporaryDirectory() as work:
        folder = pathlib.Path(work)
        for target in TARGETS:
            check(folder, target, names[-1])  # makes the stubs
        with ThreadPoolExecutor(max_workers=2) as pool:
            faults = list(pool.map(lambda pair: check(folder, *pair), checks))
    for (target, name), fault in zip(checks, faults):
        if fault:
            print(f"{target}, {name}: {fault.strip()[:400]}")
    failed = sum(fault is not None for fault in faults)
    print(f"{len(checks) - failed} checks passed, {failed} failed")
    return failed > 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
