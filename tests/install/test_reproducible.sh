#!/bin/sh
# Two builds of the same sources in different folders are equal, and hardened: test_reproducible.sh
#
# Compares the library without OpenCL, the tool and the kernels as they are put into the library, in both ways.  One build has its folder
# inside the sources, the other beside them at another depth; both with debug information, which names
# sources, and optimised little, which is quick.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM
unset KEPT_KERNELS # each build compiles its own

# build SOURCES FOLDER
build() {
    mkdir -p "$1/tests"
    (cd "$here/../.." && cp -R cl format host meson.build meson_options.txt LICENSE "$1" && cp -R tests/sample "$1/tests")
    meson setup "$2" "$1" -Dopencl=disabled -Dnative_processors=own -Dtool=enabled -Dtests=disabled -Dweb=disabled -Dplots=disabled \
        -Dopenimageio=disabled -Ddesktop=disabled -Ddebug=true -Doptimization=1 >"$work/log" &&
        ninja -C "$2" gscl libgscl.a >"$work/log" || {
        cat "$work/log"
        exit 1
    }
    (cd "$1" && python3 cl/embed.py "$2/kernel_sources.c" cl/*.cl cl/*.h)
}
build "$work/one" "$work/one/build"
build "$work/two/of a longer name/sources" "$work/two/out"

for file in libgscl.so libgscl.a gscl kernel_sources.c; do
    cmp "$work/one/build/$file" "$work/two/out/$file"
    if grep -q "$work" "$work/one/build/$file"; then
        echo "$file names the folder in which it was built"
        exit 1
    fi
done

# expect FILE READELF_OPTIONS PATTERN WHAT
expect() {
    readelf $2 "$work/one/build/$1" | grep -Eq "$3" || {
        echo "$1 has no $4"
        exit 1
    }
}
for file in libgscl.so gscl; do
    expect "$file" -lW GNU_RELRO "read-only relocations"
    expect "$file" -dW 'FLAGS.*NOW' "binding at its start, without which relocations are not all read-only"
    expect "$file" -sW __stack_chk_fail "stack protector"
    expect "$file" -sW '__(mem|str|v?sn?printf)[a-z]*_chk' "_FORTIFY_SOURCE"
done
expect gscl -dW 'Flags:.*PIE' "position-independent code"
