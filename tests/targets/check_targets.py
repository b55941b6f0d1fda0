#!/usr/bin/env python3
"""Compiles the OpenCL programs for processors that this machine lacks: check_targets.py LIST_PROGRAMS [--quick] [--write]

LIST_PROGRAMS is build/tests/targets/list_programs, which prints each program that an encode, a decode, the paper profile and
measuring can ask for.  Each is compiled and linked for each target below in two ways:

 - unoptimised: no function is inlined but those of ALWAYS_INLINE, so that a function without a definition of its own is
   missed, whichever calls the compiler of a driver inlines,
 - optimised as drivers do it, which also tells what each kernel takes.

A check is one program, target and way.  It fails where the compiler or the linker does, where a symbol is undefined and where
the target has no kernel.  Of the CPU mapping, which a GPU gets only where a caller asks for it, programs that differ from an
ordinary encode or from the paper profile by one option are not optimised: clang takes up to 25 s for one of them.  All checks
take about half an hour on two cores.

--quick leaves out all programs that differ so, and optimises only those of an ordinary encode in the GPU mapping.  --write
writes KERNELS.md, from the programs of the GPU mapping.
"""
import argparse
import collections
import concurrent.futures
import itertools
import os
import re
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
CLANG = "clang-15"
LIBCLC = "/usr/lib/clc"
PROCESSES = 2
TIMEOUT = 1800  # seconds; ends what hangs.  The longest takes 30 s.
# As drivers compile: __OPENCL_VERSION__ is theirs to define, and they know the built-in functions without a header.
COMMON = ["-x", "cl", "-w", "-fno-caret-diagnostics", "-D__OPENCL_VERSION__=120", "-Xclang", "-finclude-default-header"]

# A line of list_programs.
Program = collections.namedtuple("Program", "mapping set kind use files options")


class Fault(Exception):
    """Why a check failed, in one line."""


def run(command):
    """What a command writes to standard error; raises Fault with the first error where it fails."""
    process = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace",
                             timeout=TIMEOUT)
    if process.returncode:
        lines = (process.stderr + process.stdout).splitlines()
        raise Fault(next((line for line in lines if "error" in line), f"{command[0]} exits with {process.returncode}"))
    return process.stderr


# ---- Targets --------------------------------------------------------------------------------------


class Target:
    """A processor, by clang's name for it and in words."""
    columns = []  # titles in KERNELS.md of the figures that compile() tells of each kernel

    def __init__(self, name, text):
        self.name, self.text = name, text

    def compile(self, source, options, optimised, folder):
        """Compiles and links a file; returns {kernel: {column: number}}, without numbers where it is not optimised."""
        raise NotImplementedError


class Amd(Target):
    """AMD's GPUs, by LLVM's code generator, which AMD's drivers use as well, and its linker."""
    columns = ["VGPRs", "SGPRs", "scratch", "LDS"]
    # The lines of the compiler that add up to each column.
    FIGURES = {"VGPRs": ["VGPRs", "AGPRs"], "SGPRs": ["SGPRs"], "scratch": ["ScratchSize [bytes/lane]"],
               "LDS": ["LDS Size [bytes/block]"]}
    REMARK = re.compile(r"remark:\s+(.+?): (\S+) \[-Rpass-analysis=kernel-resource-usage\]")

    def compile(self, source, options, optimised, folder):
        compiled, linked = os.path.join(folder, "program.o"), os.path.join(folder, "program.so")
        remarks = run([CLANG, *COMMON, *options, "-target", "amdgcn-amd-amdhsa", "-mcpu=" + self.name, "-nogpulib",
                       "-O3" if optimised else "-O0", "-Xclang", "-mlink-builtin-bitcode", "-Xclang",
                       f"{LIBCLC}/amdgcn--amdhsa.bc", "-Rpass-analysis=kernel-resource-usage", "-c", source, "-o", compiled])
        run(["ld.lld", "-shared", "--no-undefined", compiled, "-o", linked])
        return self.kernels(remarks, optimised)

    def kernels(self, remarks, optimised):
        """Local memory is told of kernels, not of the functions that they call."""
        found = []
        for name, value in self.REMARK.findall(remarks):
            if name == "Function Name":
                found.append({name: value})
            else:
                found[-1][name] = value
        return {function["Function Name"]: {column: sum(int(function.get(name, 0)) for name in names)
                                            for column, names in self.FIGURES.items()} if optimised else {}
                for function in found if "LDS Size [bytes/block]" in function}


class Nvidia(Target):
    """NVIDIA's GPUs, as far as PTX, from which the driver makes code.  It is the driver that links and gives registers."""
    columns = ["stack", "shared"]
    # libclc 15 makes native_exp2 a call of C's exp2f there.  NVIDIA's own compiler has an instruction for it.
    OPTIONS = ["-Dnative_exp2=exp2"]
    # What it returns, its name and its parameters; declarations end with a semicolon.
    FUNCTION = re.compile(r"^(?:\.\w+\s+)*\.(func|entry)\s+(?:\([^)]*\)\s*)?([\w$]+)\s*(?:\([^)]*\))?[^;{]*([;{])",
                          re.MULTILINE)
    EXTERNAL = re.compile(r"^\.extern\s.*?([\w$]+)(?:\[\d*\])?;", re.MULTILINE)
    STACK = re.compile(r"^\s*\.local\s.*\b__local_depot\d+\[(\d+)\]", re.MULTILINE)
    SHARED = re.compile(r"^\s*(?:\.\w+\s+)*\.shared\s+\.align\s+\d+\s+\.b(\d+)\s+([\w$]+)(?:\[(\d+)\])?", re.MULTILINE)
    NAME = re.compile(r"[\w$]+")

    def compile(self, source, options, optimised, folder):
        compiled = os.path.join(folder, "program.ptx")
        run([CLANG, *COMMON, *self.OPTIONS, *options, "-target", "nvptx64-nvidia-nvcl", "-Xclang", "-target-cpu", "-Xclang",
             self.name, "-Xclang", "-target-feature", "-Xclang", "+ptx70", "-O3" if optimised else "-O0", "-Xclang",
             "-mlink-builtin-bitcode", "-Xclang", f"{LIBCLC}/nvptx64--nvidiacl.bc", "-S", source, "-o", compiled])
        with open(compiled, encoding="utf-8") as file:
            return self.kernels(re.sub(r"//.*", "", file.read()), optimised)

    def kernels(self, text, optimised):
        functions = list(self.FUNCTION.finditer(text))
        ends = [function.start() for function in functions[1:]] + [len(text)]
        bodies = {function[2]: text[function.end():end] for function, end in zip(functions, ends) if function[3] == "{"}
        undefined = {function[2] for function in functions} - set(bodies) | set(self.EXTERNAL.findall(text))
        if undefined:
            raise Fault("undefined symbol: " + " ".join(sorted(undefined)))
        kernels = [function[2] for function in functions if function[1] == "entry"]
        if not optimised:
            return {kernel: {} for kernel in kernels}
        names = {name: set(self.NAME.findall(body)) for name, body in bodies.items()}
        shared = {name: int(bits) // 8 * int(length or 1) for bits, name, length in self.SHARED.findall(text)}
        return {kernel: {"stack": self.stack(kernel, bodies, names),
                         "shared": sum(shared.get(name, 0) for name in self.reached(kernel, names))}
                for kernel in kernels}

    def stack(self, function, bodies, names):
        """Bytes of the deepest path of calls; OpenCL C has no recursion."""
        calls = (names[function] & set(bodies)) - {function}
        deepest = max((self.stack(call, bodies, names) for call in calls), default=0)
        return deepest + sum(map(int, self.STACK.findall(bodies[function])))

    def reached(self, function, names):
        """All names in a function and in those that it calls."""
        found, open_functions = set(), {function}
        while open_functions:
            new = names[open_functions.pop()] - found
            found |= new
            open_functions |= new & set(names)
        return found


TARGETS = [Nvidia("sm_75", "NVIDIA Turing"), Amd("gfx90a", "AMD CDNA 2"), Amd("gfx1100", "AMD RDNA 3")]

# What clang 15 cannot optimise, by target, mapping and kind, with its words, which depend on where it gives up: such a check
# passes where it fails like this, too.  The vectors of 16 doubles of the CPU mapping, which only measuring asks for, take more
# registers than there are.
LIMITS = {("gfx90a", "cpu", "accuracy"): ["ran out of registers", "no registers from class available to allocate"]}

# ---- Checks ---------------------------------------------------------------------------------------


def read_programs(command):
    """The programs that list_programs prints."""
    lines = subprocess.run([command], check=True, capture_output=True, text=True).stdout.splitlines()
    return [Program(mapping, set_, kind, use, files.split(), options.split())
            for mapping, set_, kind, use, files, options in (line.split("\t") for line in lines)]


def write_source(path, files):
    """As the library gives the files to the compiler (cl/embed.py)."""
    with open(path, "w", encoding="ascii") as source:
        for name in files:
            with open(os.path.join(ROOT, "cl", name), encoding="ascii") as file:
                source.write(f'#line 1 "cl/{name}"\n' + file.read())


def check(program, target, optimised):
    """The kernels of a program, and None or why the check failed."""
    with tempfile.TemporaryDirectory() as folder:
        source = os.path.join(folder, "program.cl")
        write_source(source, program.files)
        try:
            kernels = target.compile(source, program.options, optimised, folder)
        except (Fault, subprocess.TimeoutExpired) as error:
            limits = LIMITS.get((target.name, program.mapping, program.kind), []) if optimised else []
            return {}, None if any(limit in str(error) for limit in limits) else str(error).replace(folder, "")
    return kernels, None if kernels else "no kernel"


def is_optimised(program, quick):
    """Whether a program is compiled optimised, too."""
    if quick:
        return (program.mapping, program.set) == ("gpu", "encode")
    return program.mapping != "cpu" or program.set != "other"


def checks(programs, quick):
    """(program, target, optimised) of each check."""
    for program, target in itertools.product(programs, TARGETS):
        if not quick or program.set != "other":
            yield program, target, False
        if is_optimised(program, quick):
            yield program, target, True


# ---- KERNELS.md -----------------------------------------------------------------------------------

REPORT = """# What the kernels take on GPUs

`python3 tests/targets/check_targets.py build/tests/targets/list_programs --write` wrote this file, with Debian 12's clang 15
and libclc 15 at -O3.  It is of the GPU mapping.  The compilers of drivers are relatives of this one and allocate registers in
ways of their own: the figures show which kernels need much, not how much a driver takes.

%s.

 - VGPRs: vector registers of a work-item, those for accumulation included.  gfx90a has 512, gfx1100 256, of which this
   compiler takes 128.
 - SGPRs: scalar registers of a wave.
 - scratch, stack: bytes of private memory of a work-item that is not in registers: arrays, and registers that are spilled.  A
   device reserves it for all work-items that it can run at once.
 - LDS, shared: bytes of local memory of a work-group, with private arrays that the compiler moves there.

PTX, which is what clang makes for NVIDIA, has no registers yet: its stack is without spilled ones.
"""


def row(cells):
    return "| " + " | ".join(map(str, cells)) + " |"


def table(rows):
    """`rows`: {(program, kernel): {target: {column: number}}}"""
    columns = [(target, column) for target in TARGETS for column in target.columns]
    yield row(["program", "kernel"] + [f"{target.name} {column}" for target, column in columns])
    yield row(["---", "---"] + ["---:"] * len(columns))
    for (program, kernel), figures in rows.items():
        yield row([program, kernel] + [figures.get(target.name, {}).get(column, "") for target, column in columns])


def encode_rows(results):
    """The kernels of an ordinary encode."""
    rows = {}
    for program, target, kernels in results:
        if program.set == "encode":
            for kernel, figures in kernels.items():
                rows.setdefault((program.kind + program.use.removeprefix("encode"), kernel), {})[target.name] = figures
    return rows


def largest_rows(results):
    """The largest figure of each kernel, whatever the options."""
    rows = {}
    for program, target, kernels in results:
        for kernel, figures in kernels.items():
            largest = rows.setdefault((program.kind, kernel), {}).setdefault(target.name, {})
            largest.update({column: max(number, largest.get(column, 0)) for column, number in figures.items()})
    return dict(sorted(rows.items()))


def write_report(results):
    """`results`: (program, target, kernels) of the optimised programs of the GPU mapping."""
    lines = [REPORT % ", ".join(f"{target.name}: {target.text}" for target in TARGETS)]
    lines += ["## An encode with the default settings and a decode", "", *table(encode_rows(results)), ""]
    lines += ["## The largest figures over all options", "", *table(largest_rows(results)), ""]
    with open(os.path.join(HERE, "KERNELS.md"), "w", encoding="utf-8") as file:
        file.write("\n".join(lines))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("list_programs", metavar="LIST_PROGRAMS")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    if options.quick and options.write:
        parser.error("KERNELS.md is of all options: --write goes without --quick")
    todo = list(checks(read_programs(options.list_programs), options.quick))
    results, failed = [], 0
    with concurrent.futures.ThreadPoolExecutor(PROCESSES) as pool:
        for (program, target, optimised), (kernels, fault) in zip(todo, pool.map(lambda of: check(*of), todo)):
            if fault:
                failed += 1
                print(f"{target.name}, {'optimised' if optimised else 'unoptimised'}, {program.mapping} mapping, "
                      f"{program.kind} ({program.use}): {fault}", flush=True)
            elif optimised and program.mapping == "gpu":
                results.append((program, target, kernels))
    if options.write and not failed:
        write_report(results)
    print(f"{len(todo) - failed} checks passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
