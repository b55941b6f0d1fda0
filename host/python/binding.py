"""Writes the C source of the module _gscl, through which Python calls libgscl: binding.py OUTPUT HEADER...

The declarations are those of the library's headers, so that they cannot differ from it.
"""
import re
import sys

import cffi

CALLBACKS = 'extern "Python" bool gscl_python_progress(void *opaque, const gscl_progress *progress);'


def declarations(header):
    """The declarations of a header in the part of C that cffi reads."""
    text = re.sub(r"/\*.*?\*/", "", header, flags=re.S)
    text = re.sub(r"^static inline .*?^}", "", text, flags=re.M | re.S)
    text = re.sub(r"\b(GSCL_API|GSCL_CHECKED)\b", "", text)
    text = re.sub(r'^extern "C" {|^}$', "", text, flags=re.M)
    constant = re.compile(r"#define \w+ \d+\s*$")
    return "\n".join(line for line in text.splitlines() if not line.startswith("#") or constant.match(line))


def main(output, *headers):
    builder = cffi.FFI()
    for header in headers:
        with open(header, encoding="utf-8") as file:
            builder.cdef(declarations(file.read()))
    builder.cdef(CALLBACKS)
    builder.set_source("gscl._gscl", "#include <gscl/gscl.h>\n#include <gscl/measure.h>")
    builder.emit_c_code(output)


if __name__ == "__main__":
    main(*sys.argv[1:])
