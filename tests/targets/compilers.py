"""Compilers for the processors that check_targets.py compiles for, and the figures of each kernel that they tell."""
import os
import re
import subprocess

import ptxas

CLANG = "clang-16"  # 15 takes only 128 of the 256 vector registers of gfx1100
LIBCLC = "/usr/lib/clc"
TIMEOUT = 1800  # seconds; ends what hangs.  The longest takes 30 s.
# As drivers compile: __OPENCL_VERSION__ is theirs to define, and they know the built-in functions without a header.
COMMON = ["-x", "cl", "-w", "-fno-caret-diagnostics", "-D__OPENCL_VERSION__=120", "-Xclang", "-finclude-default-header"]


class Fault(Exception):
    """Why a check failed, in one line."""


def run(command):
    """What a command writes to standard error; raises Fault with the first error where it fails."""
    process = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace",
                             timeout=TIMEOUT)
    if process.returncode:
        lines = (process.stderr + process.stdout).splitlines()
        errors = (line for line in lines if "error" in line or "fatal" in line)
        raise Fault(next(errors, f"{command[0]} exits with {process.returncode}"))
    return process.stderr


# ---- Targets --------------------------------------------------------------------------------------


class Target:
    """A processor, by clang's name for it."""

    def __init__(self, name):
        self.name = name

    def compile(self, source, options, optimised, folder):
        """Compiles and links a file; returns {kernel: {device: {column: number}}}, without devices where it is not optimised."""
        raise NotImplementedError


class Amd(Target):
    """AMD's GPUs, by LLVM's code generator, which AMD's drivers use as well, and its linker."""
    # The lines of the compiler that add up to each column.
    FIGURES = {"VGPRs": ["VGPRs", "AGPRs"], "SGPRs": ["SGPRs"], "scratch": ["ScratchSize [bytes/lane]"],
               "spilled": ["VGPRs Spill"], "LDS": ["LDS Size [bytes/block]"], "waves": ["Occupancy [waves/SIMD]"]}
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
        return {function["Function Name"]: {self.name: self.figures(function)} if optimised else {}
                for function in found if "LDS Size [bytes/block]" in function}

    def figures(self, function):
        return {column: sum(int(function.get(name, 0)) for name in names) for column, names in self.FIGURES.items()}


class Nvidia(Target):
    """NVIDIA's GPUs: PTX, from which the driver makes code, and where there is ptxas, code for ARCHITECTURES as well.  The
    figures of PTX are without registers; its stack is that of private arrays, its shared memory that of local ones."""
    ARCHITECTURES = ["sm_75", "sm_90"]
    # libclc 15 makes native_exp2 a call of C's exp2f there.  NVIDIA's own compiler has an instruction for it.
    OPTIONS = ["-Dnative_exp2=exp2"]
    # What it returns, its name and its parameters; declarations end with a semicolon.
    FUNCTION = re.compile(r"^(?:\.\w+\s+)*\.(func|entry)\s+(?:\([^)]*\)\s*)?([\w$]+)\s*(?:\([^)]*\))?[^;{]*([;{])",
                          re.MULTILINE)
    EXTERNAL = re.compile(r"^\.extern\s.*?([\w$]+)(?:\[\d*\])?;", re.MULTILINE)
    STACK = re.compile(r"^\s*\.local\s.*\b__local_depot\d+\[(\d+)\]", re.MULTILINE)
    SHARED = re.compile(r"^\s*(?:\.\w+\s+)*\.shared\s+\.align\s+\d+\s+\.b(\d+)\s+([\w$]+)(?:\[(\d+)\])?", re.MULTILINE)
    NAME = re.compile(r"[\w$]+")

    def __init__(self, name, assembler):
        """`assembler`: the path of ptxas, or None."""
        super().__init__(name)
        self.assembler = assembler

    def compile(self, source, options, optimised, folder):
        compiled = os.path.join(folder, "program.ptx")
        run([CLANG, *COMMON, *self.OPTIONS, *options, "-target", "nvptx64-nvidia-nvcl", "-Xclang", "-target-cpu", "-Xclang",
             self.name, "-Xclang", "-target-feature", "-Xclang", "+ptx70", "-O3" if optimised else "-O0", "-Xclang",
             "-mlink-builtin-bitcode", "-Xclang", f"{LIBCLC}/nvptx64--nvidiacl.bc", "-S", source, "-o", compiled])
        with open(compiled, encoding="utf-8") as file:
            kernels = self.kernels(re.sub(r"//.*", "", file.read()), optimised)
        if optimised and self.assembler:
            for architecture in self.ARCHITECTURES:
                self.assemble(compiled, architecture, kernels)
        return kernels

    def assemble(self, compiled, architecture, kernels):
        """Adds the figures of one architecture."""
        report = run([self.assembler, "-v", "-arch=" + architecture, compiled, "-o", compiled + ".cubin"])
        for name, figures in ptxas.kernels(report).items():
            kernels[name][architecture] = figures

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
        return {kernel: {"PTX": {"stack": self.stack(kernel, bodies, names),
                                 "shared": sum(shared.get(name, 0) for name in self.reached(kernel, names))}}
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


def targets(assembler):
    return [Nvidia("sm_75", assembler), Amd("gfx90a"), Amd("gfx1100")]
