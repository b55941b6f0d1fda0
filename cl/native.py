#!/usr/bin/env python3
"""Compiles the kernels of cl/ ahead of time, for a processor.

native.py names                                        prints the names of all programs
native.py compile PROGRAM PROCESSOR OBJECT CLANG...    compiles one; CLANG: the compiler with its options for the processor
native.py table TABLE.c CLANG PROCESSOR...             writes the table of all programs of these processors

With KEPT_KERNELS, the name of a folder, in the environment, objects are kept there, and copied by later builds that compile the
same text with the same compiler and options.

A program becomes an object file with a function for each of its kernels (gscl_native_function in
host/lib/native/programs.h), which runs a range of work-items.  All else in the file has internal linkage, since programs
are variants of the same functions.
"""
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys

from programs import COMMON, FILES, programs

FOLDER = os.path.dirname(os.path.abspath(__file__))
# A kernel's name and parameters in preprocessed text.
KERNEL = re.compile(r"__kernel\s+void (\w+)\(([^)]*)\)")
LANGUAGE = ["-x", "cl", "-cl-std=CL1.2", "-D__OPENCL_VERSION__=120"]
# The types of OpenCL C without its built-in functions, which native.h has.
TYPES = ["-cl-no-stdinc", "-include", "opencl-c-base.h"]
OPTIONS = ["-O3", "-ffp-contract=off", "-fPIC", "-fno-math-errno", "-fno-stack-protector", "-Wno-unused-function",
           "-Wno-psabi", "-Wno-constant-logical-operand"]


def preprocess(program, compiler):
    """The OpenCL C of a program in one text without macros."""
    macros = [f"-D{macro}={value}" for macro, value in program.defines().items()]
    text = "".join(f'#include "{name}"\n' for name in ["native.h", *COMMON, *FILES[program.kind]])
    # The current folder is cl/, so that messages and debug information name files by themselves.
    return subprocess.run([*compiler, *LANGUAGE, *TYPES, *macros, "-I.", "-I..", "-E", "-"], input=text, text=True,
                          cwd=FOLDER, stdout=subprocess.PIPE, check=True).stdout


def kernels_of(text):
    """The kernels of a preprocessed program: the types of the parameters of each, by name."""
    def type_of(parameter):
        return re.sub(r"\w+\s*$", "", parameter.replace("restrict ", " ")).strip()
    return {name: [type_of(part) for part in parameters.split(",")] for name, parameters in KERNEL.findall(text)}


def symbol(program, processor, kernel):
    return f"gscl_native_{processor}_{program.name}_{kernel}"


def wrapper(name, kernel, types):
    """A function that reads a kernel's arguments and runs a range of its work-items."""
    lines = [f'__attribute__((visibility("hidden"))) void {name}(const void *const *arguments, size_t first, size_t end) {{']
    for i, type_name in enumerate(types):
        lines.append(f"    {type_name} a{i} = *({type_name} const *)arguments[{i}];")
    values = "".join(f", a{i}" for i in range(len(types)))
    return "\n".join(lines + [f"    for (size_t item = first; item < end; item++) {kernel}(item{values});", "}\n"])


def source(program, processor, compiler):
    """The text that is compiled: kernels take the number of their work-item as first parameter (native.h)."""
    text = preprocess(program, compiler)
    functions = [wrapper(symbol(program, processor, kernel), kernel, types) for kernel, types in kernels_of(text).items()]
    text = KERNEL.sub(r"void \1(const size_t GSCL_ITEM, \2)", text)
    return text + "\n#pragma clang attribute pop\n" + "".join(functions)  # begun in native.h


def kept_object(command, text):
    """Where the object of a text is kept, None where none are."""
    folder = os.environ.get("KEPT_KERNELS")
    if not folder:
        return None
    version = subprocess.run([command[0], "--version"], stdout=subprocess.PIPE, check=True).stdout
    key = hashlib.sha256(version + "\0".join([os.path.realpath(FOLDER), *command, text]).encode()).hexdigest()
    return pathlib.Path(folder, key + ".o")


def compile_program(program, processor, output, compiler):
    clang, *options = compiler
    command = [clang, *LANGUAGE, "-cl-no-stdinc", *OPTIONS, *options, "-c", "-"]
    text = source(program, processor, compiler)
    kept = kept_object(command, text)
    if kept and kept.exists():
        shutil.copyfile(kept, output)
        return
    subprocess.run([*command, "-o", os.path.abspath(output)], input=text, text=True, cwd=FOLDER, check=True)
    if kept:
        kept.parent.mkdir(parents=True, exist_ok=True)
        part = kept.with_suffix(f".{os.getpid()}")
        shutil.copyfile(output, part)
        part.replace(kept)  # whole at once: other builds may compile the same text now


def row(program, processor, kernels):
    options = ", ".join(f".{name} = {value}" for name, value in program.options._asdict().items()) if program.options else ""
    lines = [f"    {{GSCL_PROGRAM_{program.kind}, {program.colours}, {program.alpha_channel}, "
             f"{str(bool(options)).lower()}, {{{options or 0}}}, {{"]
    lines += [f'        {{"{kernel}", {symbol(program, processor, kernel)}, {len(types)}}},'
              for kernel, types in kernels.items()]
    return lines + ["    }},"]


def write_table(output, compiler, processors, chosen):
    """Writes gscl_native_processors (host/lib/native/programs.h) of the programs `chosen`."""
    kernels = {program: kernels_of(preprocess(program, [compiler])) for program in chosen}
    lines = ["/* Generated by cl/native.py. */", '#include "native/programs.h"', ""]
    for processor in processors:
        lines += [f"gscl_native_function {symbol(program, processor, kernel)};"
                  for program, of_program in kernels.items() for kernel in of_program]
        lines.append(f"static const gscl_native_program programs_{processor}[] = {{")
        for program, of_program in kernels.items():
            lines += row(program, processor, of_program)
        lines.append("};\n")
    lines.append("const gscl_native_processor gscl_native_processors[] = {")
    lines += [f'    {{"{p}", sizeof programs_{p} / sizeof *programs_{p}, programs_{p}}},' for p in processors]
    lines += ["};", f"const size_t gscl_native_processor_count = {len(processors)};"]
    with open(output, "w", encoding="ascii") as file:
        file.write("\n".join(lines) + "\n")


def main(command, *arguments):
    if command == "names":
        print("\n".join(program.name for program in programs()))
    elif command == "compile":
        name, processor, output, *compiler = arguments
        compile_program(next(program for program in programs() if program.name == name), processor, output, compiler)
    else:
        output, compiler, *processors = arguments
        write_table(output, compiler, processors, programs())


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except subprocess.CalledProcessError as error:
        sys.exit(error.returncode)
