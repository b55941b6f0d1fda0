#!/bin/sh
# A library without OpenCL is small, needs libc and libm only, decodes, and refuses the rest: test_without_opencl.sh
#
# In a sandbox it decodes with no system calls but those for memory.  Builds in a temporary folder.  Its decodes must equal those of the device "host" of a library with OpenCL; they are
# compared with the pictures of tests/conformance.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM
meson setup "$work/build" "$here/../.." -Dopencl=disabled -Dtool=disabled -Dtests=disabled >"$work/log" || {
    cat "$work/log"
    exit 1
}
ninja -C "$work/build" >"$work/log" || {
    cat "$work/log"
    exit 1
}
library=$work/build/libgscl.so

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
for name in without_opencl sandbox; do
    ${CC:-cc} -std=c99 -O1 -Wall -Werror -I"$here/../../host/include" "$here/$name.c" -o "$work/$name" \
        -L"$work/build" -lgscl -Wl,-rpath,"$work/build"
done
"$work/without_opencl" "$here/../conformance/files/example.gscl"
"$work/sandbox" "$here"/../conformance/files/*.gscl
