# What a fuzz target is made of, for fuzz.sh and oss_fuzz_build.sh, which read this file with `.` from the root of the source tree.
#
# set_target TARGET sets `sources` (besides fuzz_TARGET.c), `more` (options of the compiler), `options` (of libFuzzer), `kept` (folders of
# inputs), `measured` (sources whose coverage counts) and `traced` (options for the sources).  `library` is the libgscl.a that some link.
targets="reader rows writer packets division decoder image options field"
includes="-I. -Ihost/include -Ihost -Ihost/tool"

format=$(ls format/*.c)
system="$(ls host/system/*_posix.c | grep -v machine) host/system/machine_linux.c"
image="host/tool/cli/message.c host/tool/cli/read_file.c host/tool/cli/interrupt.c host/tool/cli/output_file.c
    host/tool/cli/name_hash.c $system
    $(ls host/tool/image/*.c host/colours/*.c | grep -v -e synthetic_image -e jpeg2000)"
# What gscl_decode_rows calls.
rows="$(ls host/lib/software/*.c) host/lib/decode/blend.c host/lib/decode/coded_image.c host/lib/decode/decode_rows.c
    host/lib/decode/decode_settings.c host/lib/decode/dequantise.c host/lib/decode/draw_rows.c host/lib/decode/format_result.c
    host/lib/decode/frame.c host/lib/decode/output.c host/lib/decode/packet_repair.c host/lib/decode/resize.c host/lib/image/image.c host/lib/runtime/context.c host/lib/runtime/elementary.c
    host/lib/runtime/result.c host/lib/runtime/struct_size.c host/lib/runtime/text.c"
image_libraries=$(pkg-config --cflags --libs libpng zlib libjpeg lcms2)

set_target() {
    target=$1
    # Comparisons are not traced in those of the format, which makes the reader five times faster.
    traced=
    case $target in
    reader | rows | writer | packets | division | decoder) traced=-fno-sanitize-coverage=trace-cmp ;;
    esac

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
        options="-max_len=512 -entropic=0"
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
        sources="tests/fuzz/coded_memory.c tests/fuzz/coded_scene.c tests/fuzz/packet_list.c tests/fuzz/sample.c $format"
        options="-max_len=512 -entropic=0"
        measured="format/packet.c format/repair.c format/classes.c"
        ;;
    decoder)
        sources="tests/fuzz/coded_memory.c tests/fuzz/mutator.c tests/fuzz/packet_mutator.c tests/fuzz/sample.c
            host/lib/decode/decoder.c"
        options="-max_len=256 -entropic=0"
        more="-Ihost/lib $library -lm"
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
        sources="$(ls host/tool/cli/*.c host/tool/commands/*.c host/tool/image/*.c host/tool/tradeoff/*.c host/colours/*.c | grep -v -e jpeg2000 -e without_) host/tool/plot/plot.c
            $system"
        options="-max_len=300 -close_fd_mask=3"
        more="-Wl,--wrap=options_parse $library $image_libraries -lm -ldl"
        measured="host/tool/cli/options.c host/tool/cli/colour_name.c host/tool/commands/effect_list.c host/tool/cli/base64.c"
        ;;
    field)
        sources="host/tool/commands/field_file.c host/tool/cli/message.c host/tool/cli/names.c host/tool/cli/read_file.c
            host/tool/cli/interrupt.c $system"
        options="-max_len=2000 -close_fd_mask=2 -malloc_limit_mb=200"
        more="$library -lm -ldl"
        measured=host/tool/commands/field_file.c
        ;;
    *)
        echo "fuzz: $target: not a target" >&2
        exit 2
        ;;
    esac
}
