#!/bin/sh
# Fuzzes with AddressSanitizer and UndefinedBehaviorSanitizer, from the root of the source tree:
#
#     sh tests/fuzz/fuzz.sh TARGET FOLDER [OPTIONS OF LIBFUZZER]      such as -max_total_time=60 or -runs=1000000
#     sh tests/fuzz/fuzz.sh TARGET FOLDER coverage                    the parts of format/ that the inputs run
#
# TARGET: reader.  FOLDER: holds the program, and in FOLDER/corpus the inputs that were found.  Those of tests/fuzz/corpus/TARGET
# and the conformance set are read, too.  An input that fails is kept as FOLDER/crash-...
#
# Installs clang, and with it LLVM's tools and the libraries of the sanitizers.  Comparisons are not traced, which makes the
# reader five times faster; inputs of up to 64 bytes take 70 to 180 microseconds.
set -eu
cd "$(dirname "$0")/../.."
. tests/setup.sh
install_packages clang llvm libclang-rt-dev
target=$1
folder=$2
shift 2
case $target in
reader) sources="tests/fuzz/coded_memory.c tests/fuzz/reader_mutator.c" ;;
*) echo "fuzz: $target: not a target" >&2; exit 2 ;;
esac
mkdir -p "$folder/corpus"
sources="tests/fuzz/fuzz_$target.c $sources $(ls format/*.c)"
kept="tests/fuzz/corpus/$target tests/conformance/files"
if [ "${1-}" = coverage ]; then
    clang -std=c99 -g -O1 -I. -fprofile-instr-generate -fcoverage-mapping $sources tests/fuzz/replay.c -o "$folder/coverage-$target"
    LLVM_PROFILE_FILE=$folder/profile "$folder/coverage-$target" tests/fuzz/corpus/$target "$folder/corpus"
    llvm-profdata merge "$folder/profile" -o "$folder/profile.data"
    exec llvm-cov report "$folder/coverage-$target" -instr-profile="$folder/profile.data" format
fi
clang -std=c99 -g -O2 -I. -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=undefined \
    -fno-sanitize-coverage=trace-cmp $sources -o "$folder/fuzz-$target"
exec "$folder/fuzz-$target" -max_len=64 -entropic=0 -artifact_prefix="$folder/" -print_final_stats=1 "$@" "$folder/corpus" $kept
