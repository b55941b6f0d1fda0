#!/bin/sh
# gpu_day.sh without a GPU, as its package runs it: test_gpu_day.sh BUILD
#   - without an OpenCL library it says so and exits with 3,
#   - a step that hangs is cut at its limit with all its processes, and the next one runs,
#   - no step begins after the limit of all.
# PoCL takes the place of the GPU; tests/cli/odd_opencl.c makes its first launch hang.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=$(cd "$1" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM
pocl=/etc/OpenCL/vendors/pocl.icd

make_package() {
    mkdir "$work/pictures"
    "$build/gscl" decode "$here/../conformance/files/photograph.gscl" -o "$work/pictures/photograph.png" --scale 8 --device host
    LARGE_TILES=1 sh "$here/pack_gpu_day.sh" "$build" "$work/pictures" "$work/package"
}

# day CODE LIBRARY: the script exits with CODE.
day() {
    expected=$1
    shift
    code=0
    OUT=$work/out sh "$work/package/gpu_day.sh" "$@" || code=$?
    [ "$code" = "$expected" ] || { echo "exits with $code, not with $expected"; exit 1; }
}

# says TEXT: the summary has a line that begins so.
says() {
    grep -q "^$1" "$work/out/summary.txt" || { echo "the summary lacks: $1"; exit 1; }
}

make_package
day 3 "$work/absent.so"
says "There is no OpenCL library"

DAY_STEPS="info first_encode variants" DAY_STEP_LIMIT=5 LD_PRELOAD=$build/tests/libodd_opencl.so ODD_OPENCL=hang day 1 $pocl
says "info: done"
says "first_encode: CUT at its limit"
! grep -lsa "[g]scl.encode.$work" /proc/[0-9]*/cmdline || { echo "what hangs has not ended"; exit 1; }
says "variants: done"
says "    left out: the package has no builds"

DAY_STEPS="info variants" DAY_LIMIT=0 day 1 $pocl
says "variants: no time left"
echo "ok"
