#!/bin/sh
# Looks for uninitialised values, wrong accesses and leaks with valgrind: check_valgrind.sh BUILD [all]
#
# BUILD is a release build with tests.  What is looked at: the reader and the writer of the format, the decoder of the device
# "host", which draws the conformance set, and the tool's image loaders and options.  `all` takes every kept input of the
# fuzz targets and every file of the set (a minute and a half); without it, a sample (ten seconds).
set -eu
cd "$(dirname "$0")/.."
build=$1
mode=${2-sample}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

memcheck() {
    valgrind -q --error-exitcode=9 --leak-check=full --errors-for-leak-kinds=definite "$@" >"$folder/log" 2>&1 ||
        { tail -n 60 "$folder/log"; return 1; }
}

# sample FILES...: every eighth of them, or all.
sample() {
    for file in "$@"; do
        echo "$file"
    done | if [ "$mode" = all ]; then cat; else awk 'NR % 8 == 1'; fi
}

for target in reader writer image options; do
    [ ! -x "$build/tests/fuzz_$target" ] || memcheck "$build/tests/fuzz_$target" $(sample tests/fuzz/corpus/$target/*)
done
memcheck "$build/tests/codes" decode-host whole "$folder" $(sample tests/conformance/files/*.gscl*)
