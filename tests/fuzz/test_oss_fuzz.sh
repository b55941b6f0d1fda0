#!/bin/sh
# oss_fuzz_build.sh builds targets that run over the inputs beside them, with their options: test_oss_fuzz.sh [TARGET...]
set -eu
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../setup.sh"
install_packages $build_packages libclang-rt-dev
OUT=$(mktemp -d)
trap 'rm -rf "$OUT"' EXIT INT TERM
export OUT CC=clang CXX=clang++ LIB_FUZZING_ENGINE=-fsanitize=fuzzer \
    CFLAGS="-O1 -g -fsanitize=address,undefined,fuzzer-no-link" CXXFLAGS="-g -fsanitize=address,undefined"
sh "$here/oss_fuzz_build.sh" "$@"
cd "$here/../.." && . tests/fuzz/targets.sh
for target in ${*:-$targets}; do
    program=$OUT/fuzz_$target
    options=$(sed -n 's/^\([a-z_]*\) = \(.*\)/-\1=\2/p' "$program.options")
    mkdir "$OUT/$target"
    python3 -m zipfile -e "${program}_seed_corpus.zip" "$OUT/$target"
    [ -n "$(ls "$OUT/$target")" ] || { echo "$target has no inputs"; exit 1; }
    (cd "$OUT" && "$program" $options -runs=0 "$target" >"$target.log" 2>&1) || { tail -n 20 "$OUT/$target.log"; exit 1; }
done
