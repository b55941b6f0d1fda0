#!/bin/sh
# Builds a wheel for any Linux with glibc 2.28 or later and CPython 3.10 or later: build_wheel.sh PYTHON FOLDER [PIP OPTIONS]
#
# The wheel has the library inside, with kernels for all processors of this machine's kind, and opens OpenCL where there is one.
# PYTHON: an interpreter with the packages ziglang and wheel, such as that of a virtual environment after
# `pip install ziglang wheel`; besides, clang and the headers of OpenCL are needed.  Writes FOLDER/gscl-*.whl; FOLDER/build, which
# makes the next build short; and FOLDER/zig.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
python=$1
mkdir -p "$2"
folder=$(cd "$2" && pwd)
shift 2
machine=$(uname -m)
zig=$("$python" -c 'import os, ziglang; print(os.path.join(os.path.dirname(ziglang.__file__), "zig"))')

# Zig's compiler is clang with headers and symbols of each version of glibc.  Headers of OpenCL and Python are the machine's.
export CC="$zig cc -target $machine-linux-gnu.2.28 -idirafter /usr/include -idirafter /usr/include/$machine-linux-gnu"
export AR="$zig ar" ZIG_GLOBAL_CACHE_DIR="$folder/zig" ZIG_LOCAL_CACHE_DIR="$folder/zig"
rm -f "$folder"/gscl-*.whl
"$python" -m pip --disable-pip-version-check --quiet wheel --no-deps --wheel-dir "$folder" \
    -Cbuild-dir="$folder/build" -Csetup-args=-Dstrip=true -Csetup-args=-Dgscl:native=enabled "$@" "$here"
# meson-python names the machine and the version of Python that built it.
"$python" -m wheel tags --remove --python-tag cp310 --platform-tag "manylinux_2_28_$machine" "$folder"/gscl-*.whl
