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
# Installs LLVM's tools and the libraries of the sanitizers.  In all but the last two comparisons are not traced, which makes
# the reader five times faster, and FUZZ_SAMPLE leaves checks that take long to a sample.
set -eu
cd "$(dirname "$0")/../.."
. tests/setup.sh
install_packages $build_packages llvm libclang-rt-dev
target=$1
folder=$2
shift 2

format=$(ls format/*.c)
image="host/tool/cli/message.c host/tool/cli/read_file.c host/tool/cli/interrupt.c host/tool/cli/output_file.c
    host/tool/cli/output_target.c host/tool/cli/name_hash.c
    $(ls host/tool/image/*.c host/colours/*.c | grep -v -e synthetic_image -e jpeg2000)"
# What gscl_decode_rows calls.
rows="$(ls host/lib/software/*.c) host/lib/decode/blend.c host/lib/decode/coded_image.c host/lib/decode/decode_rows.c
    host/lib/decode/decode_settings.c host/lib/decode/dequantise.c host/lib/decode/draw_rows.c host/lib/decode/frame.c
    host/lib/decode/output.c host/lib/decode/resize.c host/lib/image/image.c host/lib/runtime/context.c host/lib/runtime/elementary.c
    host/lib/runtime/result.c host/lib/runtime/struct_size.c host/lib/runtime/text.c"
image_libraries=$(pkg-config --cflags --libs libpng zlib libjpeg lcms2)
more=
kept=tests/fuzz/corpus/$target
case $target in
reader)
    sources="tests/fuzz/coded_memory.c tests/fuzz/mutator.c tests/fuzz/reader_mutator.c tests/fuzz/sample.c $format"
    options="-max_len=64 -entropic=0"
    kept="$kept tests/conformance/files"
    measured=format
    ;;
rows)
    sources="tests/fuzz/coded_memory.c tests/fuzz/mutator.c tests/fuzz/reader_mutator.c $format $rows"
    options="-max_len=64 -entropic=0"
    kept="tests/fuzz/corpus/reader tests/conformance/files"
    more="-Ihost/lib -ffp-contract=off -lm"
    measured="$rows"
    ;;
writer)
    sources="tests/fuzz/coded_memory.c tests/fuzz/coded_scene.c $format"
    options=-max_len=512
    measured=format
    ;;
packets)
    sources="tests/fuzz/coded_memory.c tests/fuzz/packet_list.c tests/fuzz/mutator.c tests/fuzz/packet_mutator.c
        tests/fuzz/sample.c $format"
    options="-max_len=256 -entropic=0"
    kept="$kept tests/conformance/files"
    measured="format/packet.c format/repair.c"
    ;;
division)
    sources="tests/fuzz/coded_memory.c tests/fuzz/coded_scene.c tests/fuzz/packet_list.c $format"
    options="-max_len=512 -entropic=0"
    measured="format/packet.c format/repair.c format/classes.c"
    ;;
decoder)
    sources="tests/fuzz/coded_memory.c tests/fuzz/mutator.c tests/fuzz/packet_mutator.c tests/fuzz/sample.c
        host/lib/decode/decoder.c"
    options="-max_len=256 -entropic=0"
    more="-Ihost/lib -fsanitize=address,undefined,fuzzer-no-link $folder/decoder/libgscl.a -lm"
    kept="$kept tests/fuzz/corpus/packets tests/conformance/files"
    measured=host/lib/decode/decoder.c
    ;;
image)
    sources="tests/fuzz/image_mutator.c $image"
    options="-max_len=4400 -close_fd_mask=2 -malloc_limit_mb=200"
    more="$image_libraries -lm"
    measured=host/tool/image
    ;;
options)
    sources="$(ls host/tool/cli/*.c host/tool/commands/*.c host/tool/image/*.c host/tool/tradeoff/*.c host/colours/*.c | grep -v jpeg2000) host/tool/plot/plot.c"
    options="-max_len=300 -close_fd_mask=3"
    more="-Wl,--wrap=options_parse $folder/library/libgscl.a $image_libraries -lm -ldl"
    measured="host/tool/cli/options.c host/tool/cli/colour_name.c host/tool/commands/effect_list.c host/tool/cli/base64.c"
    ;;
field)
    sources="host/tool/commands/field_file.c host/tool/cli/message.c host/tool/cli/names.c host/tool/cli/read_file.c
        host/tool/cli/interrupt.c"
    options="-max_len=2000 -close_fd_mask=2 -malloc_limit_mb=200"
    more="$folder/library/libgscl.a -lm -ldl"
    measured=host/tool/commands/field_file.c
    ;;
*)
    echo "fuzz: $target: not a target" >&2
    exit 2
    ;;
esac
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
compile="clang -std=c99 -g -I. -Ihost/include -Ihost -Ihost/tool"

if [ "${1-}" = coverage ]; then
    $compile -O1 -fprofile-instr-generate -fcoverage-mapping tests/fuzz/fuzz_$target.c $sources tests/fuzz/replay.c $more \
        -o "$folder/coverage-$target"
    LLVM_PROFILE_FILE=$folder/profile "$folder/coverage-$target" $kept >/dev/null 2>&1
    llvm-profdata merge "$folder/profile" -o "$folder/profile.data"
    exec llvm-cov report "$folder/coverage-$target" -instr-profile="$folder/profile.data" $measured
fi

traced=
case $target in
reader | writer | packets | division | decoder) traced=-fno-sanitize-coverage=trace-cmp ;;
esac
$compile -O2 -DFUZZ_SAMPLE -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=undefined $traced \
    tests/fuzz/fuzz_$target.c $sources $more -o "$folder/fuzz-$target"
if [ "${1-}" = minimise ]; then
    mkdir -p tests/fuzz/corpus/$target
    exec "$folder/fuzz-$target" $options -use_counters=0 -merge=1 tests/fuzz/corpus/$target $kept "$folder/corpus"
fi
exec "$folder/fuzz-$target" $options -artifact_prefix="$folder/" -print_final_stats=1 "$@" "$folder/corpus" $kept
