#!/bin/sh
# Checks that aarch64 gives the files of tests/unit/golden.txt: check_golden.sh [--all | CASE...]
#
# Builds the library with its kernels for aarch64 in build-portability/golden-aarch64 by a cross compiler of Debian, and encodes
# with it in qemu-user: without an argument a few small cases, with --all all of them, in half an hour of processor
# time.  Prints the lines that differ, and then one line of counts.
set -u
cd "$(dirname "$0")/../.."
. tests/setup.sh
# Both profiles, an alpha channel, blending by alpha and the visual loss, in 40 s of processor time.
[ $# -gt 0 ] || set -- 33x2 rgba blend-alpha paper tune-visual
[ "$1" != --all ] || shift
install_packages $build_packages $(machine_packages aarch64) || exit 1
folder=$PWD/build-portability/golden-aarch64
log=$folder.log
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

build() {
    again=
    [ ! -f "$folder/build.ninja" ] || again=--reconfigure
    # Without the libraries of this machine, cmocka among them.
    PKG_CONFIG_LIBDIR=$work meson setup $again "$folder" --cross-file tests/portability/aarch64.ini -Dopencl=disabled \
        -Dnative=enabled -Dtests=auto -Dtool=disabled -Dweb=disabled -Dopenimageio=disabled -Ddesktop=disabled &&
        ninja -C "$folder" tests/golden
}

mkdir -p build-portability
build >"$log" 2>&1 || { tail -n 20 "$log"; echo "aarch64: no build, see $log"; exit 1; }
qemu-aarch64 -L /usr/aarch64-linux-gnu "$folder/tests/golden" "$@" >"$work/made" || {
    echo "aarch64: an encode failed"
    exit 1
}
grep -vxFf tests/unit/golden.txt "$work/made"
differing=$(grep -cvxFf tests/unit/golden.txt "$work/made")
echo "aarch64: $(wc -l <"$work/made") files, $differing not those of golden.txt"
[ "$differing" = 0 ] && [ -s "$work/made" ]
