#!/bin/sh
# A library that only decodes is small, needs libc and libm only, and makes no system calls but those for memory when it decodes:
# test_without_opencl.sh BUILD
#
# BUILD is a release build with -Dopencl=disabled -Dnative=disabled, whose tests say what it decodes.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=$(cd "$1" && pwd)
library=$build/libgscl.so
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM

strip -o "$work/stripped" "$library" # as packages install it
size=$(stat -c %s "$work/stripped")
if [ "$size" -gt 102400 ]; then
    echo "the library has $size bytes, at most 102400 are expected"
    exit 1
fi
needed=$(readelf -d "$library" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | sort | tr '\n' ' ')
if [ "$needed" != "libc.so.6 libm.so.6 " ]; then
    echo "the library needs $needed"
    exit 1
fi
sh "$here/check_exports.sh" "$library"
${CC:-cc} -std=c99 -O1 -Wall -Werror -I"$here/../../host/include" "$here/sandbox.c" -o "$work/sandbox" \
    -L"$build" -lgscl -Wl,-rpath,"$build"
"$work/sandbox" "$here"/../conformance/files/*.gscl
