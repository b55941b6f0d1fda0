#!/bin/sh
# Runs every kernel in oclgrind, which reports wrong API calls, accesses outside buffers and data races:
# test_oclgrind.sh GSCL
# A tiny image of two tiles is encoded and decoded in each blend mode and mapping, at the lowest effort that runs all
# of the mode's kernels.  Prints TAP, one test for each pair.
set -u
gscl=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
image=$work/tiny.ppm
awk 'BEGIN {
    print "P3 20 12 255"
    for (y = 0; y < 12; y++)
        for (x = 0; x < 20; x++)
            print 12 * x, 20 * y, (x - 12) ^ 2 + (y - 6) ^ 2 < 12 ? 220 : 40
}' >"$image"

# oclgrind exits with 0 whatever it finds, so that any output is a failure.  The optimiser is off, because
# oclgrind does not support all of its output for `restrict` pointers.
is_silent() {
    oclgrind --build-options -cl-opt-disable --check-api --data-races "$gscl" "$@" >"$work/output" 2>&1 && ! grep -q . "$work/output"
}

# Oclgrind takes the place of OpenCL's functions by LD_PRELOAD: without it PoCL would run the kernels, and find nothing.
echo 1..13
number=1
if oclgrind "$gscl" devices 2>&1 | grep -q "Oclgrind"; then
    echo "ok 1 - kernels run in oclgrind"
else
    echo "not ok 1 - kernels run in oclgrind"
fi
for mapping in cpu gpu; do
    for mode in "--effort 1 --blend normalized" "--effort 0 --tune ssim" "--effort 0 --tune visual" "--effort 0 --blend alpha" "--effort 1 --blend sum" "--effort 0 --profile paper"; do
        number=$((number + 1))
        if is_silent encode "$image" -o "$work/coded.gscl" --splats 4 $mode --device Oclgrind --mapping $mapping --quiet &&
            is_silent decode "$work/coded.gscl" -o "$work/decoded.png" --device Oclgrind --mapping $mapping; then
            echo "ok $number - $mode, $mapping"
        else
            echo "not ok $number - $mode, $mapping"
            head -n 20 "$work/output" | sed 's/^/# /'
        fi
    done
done
