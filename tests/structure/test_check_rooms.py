#!/usr/bin/env python3
"""check_rooms.py passes on this tree and fails on each fault that it checks."""
import os
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))


def check(root, *arguments):
    run = subprocess.run([sys.executable, os.path.join(HERE, "check_rooms.py"), "--root", root, *arguments],
                         capture_output=True, text=True)
    return run.returncode, run.stdout


def append(root, path, text):
    with open(os.path.join(root, path), "a", encoding="utf-8") as file:
        file.write(text)


def include(path, name):
    return lambda root: append(root, path, f'\n#include {name}\n')


def code(path, text):
    return lambda root: append(root, path, f"\n{text}\n")


def remove(path):
    return lambda root: os.remove(os.path.join(root, path))


def circle(root):
    append(root, "host/lib/fit/one.h", '#include "fit/two.h"\n')
    append(root, "host/lib/fit/two.h", '#include "fit/one.h"\n')


def new_room(root):
    os.mkdir(os.path.join(root, "host/lib/attic"))
    append(root, "host/lib/attic/attic.h", "\n")


def rename_in_room(root):
    path = os.path.join(root, "host/lib/fit/room.h")
    with open(path, encoding="utf-8") as file:
        text = file.read()
    with open(path, "w", encoding="utf-8") as file:
        file.write(text.replace("fit.h", "no_such_file.h", 1))


FAULTS = {
    "an include of a higher room": (include("host/lib/runtime/context.c", '"fit/fit.h"'), "upward, from runtime to fit"),
    "an include from format/ of the library": (include("format/header.c", '"host/lib/fit/fit.h"'), "may not use host/lib"),
    "an include of the tool of a private header": (include("host/tool/main.c", '"host/lib/fit/fit.h"'), "may not use"),
    "a question for the operating system": (code("host/lib/fit/fit.c", "#ifdef _WIN32\n#endif"), "asks for _WIN32"),
    "an include of the library of the tool": (include("host/lib/fit/fit.c", '"host/tool/cli/json.h"'), "may not use"),
    "an include of a binding of the library": (include("host/openimageio/gscl_plugin.h", '"host/lib/fit/fit.h"'), "may not use"),
    "a public header with a private one": (include("host/include/gscl/gscl.h", '"fit/fit.h"'), "public headers only"),
    "an include that names no file": (include("host/tool/main.c", '"fit/fit.h"'), "names no file"),
    "headers in a circle": (circle, "circle: host/lib/fit/one host/lib/fit/two"),
    "a room that is not listed": (new_room, "attic is not in the list"),
    "a room without room.h": (remove("host/lib/fit/room.h"), "is missing"),
    "a room.h that names a missing file": (rename_in_room, "names no_such_file.h"),
    "an include of OpenCL's room by one that is not for devices": (include("host/lib/fit/fit.c", '"opencl/program.h"'),
                                                                   "fit may not use opencl"),
    "a header of OpenCL outside its room": (include("cl/structs.h", "<CL/cl.h>"), "names CL/cl.h of OpenCL"),
    "a type of OpenCL outside its room": (code("host/lib/fit/fit.c", "static cl_int count;"), "names cl_int of OpenCL"),
    "a struct of OpenCL outside its room": (code("host/lib/fit/fit.h", "struct _cl_mem;"), "names _cl_mem of OpenCL"),
    "a constant of OpenCL outside its room": (code("host/lib/device/open_device.c", "int i = CL_SUCCESS;"),
                                              "names CL_SUCCESS of OpenCL"),
    "a call of OpenCL outside its room": (code("host/tool/main.c", "void f(void) { clFinish(0); }"), "names clFinish of"),
    "OpenCL in comments and texts": (code("host/lib/fit/fit.c", "/* cl_int */ const char *s = \"clFinish\";"), None),
    "a function that rounds as the machine does": (code("host/lib/fit/fit.c", "double f(double x) { return exp(x); }"), "calls exp of"),
    "one in single precision": (code("format/model.c", "float f(float x) { return log2f(x); }"), "calls log2f of"),
    "one in a room whose results are in no file": (code("host/lib/measure/subject.c", "double g(double x) { return exp(x); }"), None),
    "a header that its room.h does not name": (lambda root: append(root, "host/lib/fit/new.h", "\n"), "not name new.h"),
}


def copy_tree(root):
    for top in ("format", "cl", "host"):
        shutil.copytree(os.path.join(ROOT, top), os.path.join(root, top), symlinks=True)


def compile_objects(root, sources):
    """Objects of sources that call each other, named as meson names them."""
    folder = os.path.join(root, "objects")
    os.mkdir(folder)
    for path, text in sources.items():
        append(root, path, text)
        subprocess.run(["cc", "-x", "c", "-c", "-", "-o", os.path.join(folder, path.replace("/", "_") + ".o")],
                       input=text, text=True, check=True)
    return folder


def call_upward(root):
    return compile_objects(root, {"host/lib/runtime/low.c": "void above(void); void low(void) { above(); }\n",
                                  "host/lib/fit/above.c": "void above(void) {}\n"})


def call_in_a_circle(root):
    return compile_objects(root, {"host/lib/fit/a.c": "void b(void); void a(void) { b(); }\n",
                                  "host/lib/fit/b.c": "void a(void); void b(void) { a(); }\n"})


def call_from_tool(root):
    return compile_objects(root, {"host/tool/cli/a.c": "void hidden(void); void a(void) { hidden(); }\n",
                                  "host/lib/fit/b.c": "void hidden(void) {}\n"})


def call_public(root):
    return compile_objects(root, {"host/tool/cli/a.c": "void gscl_free(void *); void a(void) { gscl_free(0); }\n",
                                  "host/lib/runtime/b.c": "void gscl_free(void *p) { (void)p; }\n"})


CALLS = {
    "a call of a higher room": (call_upward, "points upward, from runtime to fit"),
    "calls in a circle": (call_in_a_circle, "circle: host/lib/fit/a host/lib/fit/b"),
    "a call of the tool to a private function": (call_from_tool, "host/tool may not use host/lib"),
    "a call of the tool to a public function": (call_public, None),
    "a folder without objects": (lambda root: os.path.join(root, "format"), "no object files"),
}


def is_expected(status, text, fault):
    """Whether the script found the fault, or none where that is None."""
    return status == 1 and fault in text if fault else status == 0


def outcomes():
    """Pairs of a test's name and its fault, or None."""
    status, text = check(ROOT)
    yield "this tree", text if status else None
    for name, (spoil, expected) in FAULTS.items():
        with tempfile.TemporaryDirectory() as root:
            copy_tree(root)
            spoil(root)
            status, text = check(root)
            yield name, None if is_expected(status, text, expected) else text
    for name, (make, expected) in CALLS.items():
        with tempfile.TemporaryDirectory() as root:
            copy_tree(root)
            status, text = check(root, make(root))
            yield name, None if is_expected(status, text, expected) else text


def main():
    failed = 0
    for name, text in outcomes():
        print(("ok      " if text is None else "FAILED  ") + name)
        if text is not None:
            failed += 1
            print(text)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
