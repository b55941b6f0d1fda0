#!/bin/sh
# Fuzzes with AddressSanitizer and UndefinedBehaviorSanitizer, from the root of the source tree:
#
#     sh tests/fuzz/fuzz.sh TARGET FOLDER [OPTIONS OF LIBFUZZER]      such as -max_total_time=60 or -runs=1000000
#     sh tests/fuzz/fuzz.sh TARGET FOLDER minimise                    adds to tests/fuzz/corpus/TARGET what covers more
#     sh tests/fuzz/fuzz.sh TARGET FOLDER coverage                    the parts of the sources that the kept inputs run
#
# TARGET: reader, rows, writer, packets, division, decoder, image, options or field; README.md says what each does.  FOLDER: holds the program,
# and in FOLDER/corpus the inputs that were found.  Those of tests/fuzz/corpus/TARGET and, for the reader, packets and the
# decoder, the conformance set are read, too.  An input that fails is kept as FOLDER/crash-...
#
# Installs LLVM's tools and the libraries of the sanitizers.  FUZZ_SAMPLE leaves checks that take long to a sample.
set -eu
cd "$(dirname "$0")/../.."
. tests/setup.sh
install_packages $build_packages llvm libclang-rt-dev
target=$1
folder=$2
shift 2

case $target in
decoder) library=$folder/decoder/libgscl.a ;;
*) library=$folder/library/libgscl.a ;;
esac
. tests/fuzz/targets.sh
set_target "$target"
mkdir -p "$folder/corpus"
if { [ "$target" = options ] || [ "$target" = field ]; } && [ ! -f "$folder/library/libgscl.a" ]; then
    meson setup "$folder/library" -Dtool=disabled -Dtests=disabled -Dweb=disabled >/dev/null
    ninja -C "$folder/library" libgscl.a >/dev/null
fi
if [ "$target" = decoder ] && [ ! -f "$folder/decoder/libgscl.a" ]; then
    CC=clang meson setup "$folder/decoder" -Dopencl=disabled -Dnative=disabled -Dtool=disabled -Dtests=disabled -Dweb=disabled \
        -Db_sanitize=address,undefined -Db_lundef=false \
        -Dc_args="-fsanitize=fuzzer-no-link -fno-sanitize-coverage=trace-cmp" >/dev/null
    ninja -C "$folder/decoder" libgscl.a >/dev/null
fi
compile="clang -std=c99 -g $includes"
[ "$target" != decoder ] || compile="$compile -fsanitize=address,undefined,fuzzer-no-link"

if [ "${1-}" = coverage ]; then
    $compile -O1 -fprofile-instr-generate -fcoverage-mapping tests/fuzz/fuzz_$target.c $sources tests/fuzz/replay.c $more \
        -o "$folder/coverage-$target"
    LLVM_PROFILE_FILE=$folder/profile "$folder/coverage-$target" $kept >/dev/null 2>&1
    llvm-profdata merge "$folder/profile" -o "$folder/profile.data"
    exec llvm-cov report "$folder/coverage-$target" -instr-profile="$folder/profile.data" $measured
fi

$compile -O2 -DFUZZ_SAMPLE -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=undefined $traced \
    tests/fuzz/fuzz_$target.c $sources $more -o "$folder/fuzz-$target"
if [ "${1-}" = minimise ]; then
    mkdir -p tests/fuzz/corpus/$target
    exec "$folder/fuzz-$target" $options -use_counters=0 -merge=1 tests/fuzz/corpus/$target $kept "$folder/corpus"
fi
exec "$folder/fuzz-$target" $options -artifact_prefix="$folder/" -print_final_stats=1 "$@" "$folder/corpus" $kept
