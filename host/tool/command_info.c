/* gscl info: what a gscl file is, and where its bits went. */
#include <stdio.h>
#include <stdlib.h>

#include <gscl/gscl.h>

#include "command.h"
#include "device_choice.h"
#include "json.h"
#include "names.h"
#include "options.h"
#include "read_file.h"

#define EFFECT_BITS 32 /* of gscl_info.effects */

static unsigned depth_of(const gscl_info *info) {
    return info->sample == GSCL_SAMPLE_U16 ? 16 : 8;
}

static double bits_per_pixel(const gscl_info *info) {
    return 8.0 * (double)info->bytes / ((double)info->width * info->height);
}

static double per_splat(const gscl_info *info, double bits) {
    return info->splats ? bits / info->splats : 0.0;
}

/* The name of effect number `bit` when the file uses it, else NULL. */
static const char *effect_in_use(const gscl_info *info, unsigned bit) {
    return info->effects >> bit & 1 ? gscl_effect_name((gscl_effect)(1u << bit)) : NULL;
}

static void print_effects(const gscl_info *info) {
    const char *separator = " ";
    printf("effects:");
    for (unsigned bit = 0; bit < EFFECT_BITS; bit++) {
        const char *name = effect_in_use(info, bit);
        if (name) {
            printf("%s%s", separator, name);
            separator = ", ";
        }
    }
    puts(info->effects ? "" : " none");
}

static void print_streams(const gscl_info *info) {
    printf("\n%-16s%12s%14s%9s\n", "stream", "bytes", "bits/splat", "share");
    for (size_t i = 0; i < info->stream_count; i++) {
        const gscl_stream_bits *stream = &info->streams[i];
        printf("%-16s%12.1f%14.2f%7.1f %%\n", stream->name, stream->bits / 8.0, per_splat(info, stream->bits),
               100.0 * stream->bits / (8.0 * (double)info->bytes));
    }
    printf("%-16s%12llu%14.2f%7.1f %%\n", "file", (unsigned long long)info->bytes,
           per_splat(info, 8.0 * (double)info->bytes), 100.0);
}

static void print_text(const char *name, const gscl_info *info) {
    printf("%s: %u x %u %s, %u bits, format version %u\n", name, info->width, info->height,
           channels_name(info->channels), depth_of(info), info->format_version);
    printf("%u splats, %llu bytes, %.4f bits per pixel\n", info->splats, (unsigned long long)info->bytes,
           bits_per_pixel(info));
    printf("profile %s, blend %s", profile_words[info->profile], blend_words[info->blend]);
    if (info->shape_words || info->colour_words)
        printf(", code words: %u shapes, %u colours", info->shape_words, info->colour_words);
    putchar('\n');
    print_effects(info);
    print_streams(info);
}

static void write_streams(json_writer *json, const gscl_info *info) {
    json_open_array(json, "streams");
    for (size_t i = 0; i < info->stream_count; i++) {
        json_open_object(json, NULL);
        json_string(json, "name", info->streams[i].name);
        json_real(json, "bits", info->streams[i].bits);
        json_real(json, "bytes", info->streams[i].bits / 8.0);
        json_real(json, "bits_per_splat", per_splat(info, info->streams[i].bits));
        json_close_object(json);
    }
    json_close_array(json);
}

static void write_json(const char *name, const gscl_info *info) {
    json_writer json;
    json_start(&json, stdout);
    json_open_object(&json, NULL);
    json_string(&json, "file", name);
    json_integer(&json, "format_version", info->format_version);
    json_integer(&json, "width", info->width);
    json_integer(&json, "height", info->height);
    json_integer(&json, "channels", info->channels);
    json_integer(&json, "depth", depth_of(info));
    json_string(&json, "profile", profile_words[info->profile]);
    json_string(&json, "blend", blend_words[info->blend]);
    json_open_array(&json, "effects");
    for (unsigned bit = 0; bit < EFFECT_BITS; bit++) {
        if (effect_in_use(info, bit))
            json_string(&json, NULL, effect_in_use(info, bit));
    }
    json_close_array(&json);
    json_integer(&json, "splats", info->splats);
    json_integer(&json, "shape_words", info->shape_words);
    json_integer(&json, "colour_words", info->colour_words);
    json_integer(&json, "bytes", info->bytes);
    json_real(&json, "bpp", bits_per_pixel(info));
    write_streams(&json, info);
    json_close_object(&json);
}

static int inspect(const char *input, bool as_json) {
    uint8_t *bytes;
    size_t size;
    gscl_info info;
    if (!read_file(input, MAX_GSCL_FILE, &bytes, &size))
        return EXIT_FAILURE;
    const gscl_result result = gscl_inspect(bytes, size, &info);
    free(bytes);
    if (result != GSCL_OK)
        return report_result(NULL, input_label(input), result);
    if (as_json)
        write_json(input_label(input), &info);
    else
        print_text(input_label(input), &info);
    return EXIT_SUCCESS;
}

int command_info(int argc, char **argv) {
    bool as_json = false;
    const option_spec options[] = {
        {.name = "json", .kind = OPTION_FLAG, .value = &as_json, .help = "write JSON"},
    };
    const option_command command = {
        .name = "info",
        .usage = "IN.gscl [--json]",
        .about = "Checks a gscl file and shows its header, the effects that are on, and the bits of each stream.",
        .options = options,
        .option_count = sizeof options / sizeof *options,
        .min_operands = 1,
        .max_operands = 1,
    };
    int first;
    const option_outcome outcome = options_parse(&command, argc, argv, &first);
    if (outcome != OPTIONS_RUN)
        return outcome == OPTIONS_HELP ? EXIT_SUCCESS : EXIT_USAGE;
    return inspect(argv[first], as_json);
}
