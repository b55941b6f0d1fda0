#!/usr/bin/env python3
"""Compiles the OpenCL programs for processors that this machine lacks: check_targets.py LIST_PROGRAMS [--quick]

LIST_PROGRAMS is build/tests/targets/list_programs, which prints each program that an encode, a decode, the paper profile and
measuring can ask for.  Each is compiled and linked for each target in two ways:

 - unoptimised: no function is inlined but those of ALWAYS_INLINE, so that a function without a definition of its own is
   missed, whichever calls the compiler of a driver inlines,
 - optimised as drivers do it, which also tells what each kernel takes.

A check is one program, target and way.  It fails where the compiler or the linker does, where a symbol is undefined, where the
target has no kernel, and where a kernel takes more than limits.py allows.  The registers of NVIDIA's GPUs are those of ptxas,
which is installed beside LIST_PROGRAMS; where it cannot be, its limits are left out.

Of the CPU mapping, which a GPU gets only where a caller asks for it, programs that differ from an ordinary encode or from the
paper profile by one option are not optimised: clang takes up to 25 s for one of them.  All checks take about half an hour on
two cores.  --quick leaves out all programs that differ so, and optimises only those of an ordinary encode in the GPU mapping.
tests/bench/gpu.py writes what the kernels take.
"""
import argparse
import concurrent.futures
import itertools
import os
import subprocess
import sys
import tempfile

import compilers
import limits
import programs
import ptxas

PROCESSES = 2

# What clang 16 cannot optimise, by target, mapping and kind, with its words, which depend on where it gives up: such a check
# passes where it fails like this, too.  The vectors of 16 doubles of the CPU mapping, which only measuring asks for, take more
# registers than there are.
UNCOMPILED = {("gfx90a", "cpu", "accuracy"): ["ran out of registers", "no registers from class available to allocate"]}


def compile_program(program, target, optimised):
    """{kernel: {device: {column: number}}}"""
    with tempfile.TemporaryDirectory() as folder:
        source = os.path.join(folder, "program.cl")
        programs.write_source(source, program.files)
        try:
            return target.compile(source, program.options, optimised, folder)
        except (compilers.Fault, subprocess.TimeoutExpired) as error:
            raise compilers.Fault(str(error).replace(folder, "")) from error


def fault_of(program, target, optimised):
    """None or why a check failed."""
    try:
        kernels = compile_program(program, target, optimised)
    except compilers.Fault as error:
        words = UNCOMPILED.get((target.name, program.mapping, program.kind), []) if optimised else []
        return None if any(word in str(error) for word in words) else str(error)
    if not kernels:
        return "no kernel"
    return "; ".join(limits.breaches(program, kernels)) or None


def is_optimised(program, quick):
    """Whether a program is compiled optimised, too."""
    if quick:
        return (program.mapping, program.set) == ("gpu", "encode")
    return program.mapping != "cpu" or program.set != "other"


def checks(listed, targets, quick):
    """(program, target, optimised) of each check."""
    for program, target in itertools.product(listed, targets):
        if not quick or program.set != "other":
            yield program, target, False
        if is_optimised(program, quick):
            yield program, target, True


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("list_programs", metavar="LIST_PROGRAMS")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    assembler = ptxas.install(os.path.join(os.path.dirname(options.list_programs), "venv"))
    if not assembler:
        print("left out: the limits of NVIDIA's registers, as ptxas cannot be installed")
    todo, failed = list(checks(programs.read(options.list_programs), compilers.targets(assembler), options.quick)), 0
    with concurrent.futures.ThreadPoolExecutor(PROCESSES) as pool:
        for (program, target, optimised), fault in zip(todo, pool.map(lambda of: fault_of(*of), todo)):
            if fault:
                failed += 1
                print(f"{target.name}, {'optimised' if optimised else 'unoptimised'}, {program.mapping} mapping, "
                      f"{program.kind} ({program.use}): {fault}", flush=True)
    print(f"{len(todo) - failed} checks passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
