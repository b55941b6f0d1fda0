/* gscl info: the header of a gscl file, its effects, and the bits of each stream. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <gscl/gscl.h>
#include <gscl/measure.h>

#include "cli/device_choice.h"
#include "cli/gscl_input.h"
#include "cli/json.h"
#include "cli/message.h"
#include "cli/names.h"
#include "cli/options.h"
#include "cli/rate.h"
#include "cli/read_file.h"
#include "commands/command.h"
#include "image/image_file.h"

static const char *const block_names[] = {
    [GSCL_BLOCK_COLOUR_SPACE] = "colour-space",
    [GSCL_BLOCK_ICC] = "icc",
    [GSCL_BLOCK_EXIF] = "exif",
    [GSCL_BLOCK_XMP] = "xmp",
};
#define BLOCK_TYPES (sizeof block_names / sizeof *block_names)

/* The contents of the output. */
typedef struct file_facts {
    const char *name;
    gscl_info info;
    size_t block_sizes[BLOCK_TYPES]; /* bytes of content; 0: the file has no such block */
    size_t use_count;
    gscl_effect_use uses[GSCL_MAX_EFFECTS];
} file_facts;

static unsigned depth_of(const gscl_info *info) {
    return info->sample == GSCL_SAMPLE_U16 ? 16 : 8;
}

static double bits_per_splat(const gscl_info *info, double bits) {
    return info->splats ? bits / info->splats : 0.0;
}

/* Prints the effects with their bits and gains where those are known. */
static void print_effects(const file_facts *facts) {
    printf("effects:%s", facts->use_count ? "" : " none");
    for (size_t i = 0; i < facts->use_count; i++)
        printf("%s %s", i ? "," : "", gscl_effect_name(facts->uses[i].effect));
    putchar('\n');
    if (facts->use_count)
        printf("\n%-16s%12s%14s%10s\n", "effect", "bytes", "bits/splat", "gain dB");
    for (size_t i = 0; i < facts->use_count; i++) {
        const gscl_effect_use *use = &facts->uses[i];
        printf("%-16s", gscl_effect_name(use->effect));
        if (isnan(use->bits))
            printf("%12s%14s", "-", "-");
        else
            printf("%12.0f%14.2f", use->bits / 8.0, bits_per_splat(&facts->info, use->bits));
        if (isnan(use->gain_db))
            printf("%10s\n", "-");
        else
            printf("%10.2f\n", use->gain_db);
    }
}

static void print_streams(const gscl_info *info) {
    printf("\n%-16s%12s%14s%9s\n", "stream", "bytes", "bits/splat", "share");
    for (size_t i = 0; i < info->stream_count; i++) {
        const gscl_stream_bits *stream = &info->streams[i];
        printf("%-16s%12.1f%14.2f%7.1f %%\n", stream->name, stream->bits / 8.0, bits_per_splat(info, stream->bits),
               100.0 * stream->bits / (8.0 * (double)info->bytes));
    }
    printf("%-16s%12llu%14.2f%7.1f %%\n", "file", (unsigned long long)info->bytes,
           bits_per_splat(info, 8.0 * (double)info->bytes), 100.0);
}

/* Prints the blocks of the file, if it has any. */
static void print_blocks(const file_facts *facts) {
    const char *before = "blocks: ";
    for (size_t i = 0; i < BLOCK_TYPES; i++) {
        if (facts->block_sizes[i] == 0)
            continue;
        printf("%s%s (%zu bytes)", before, block_names[i], facts->block_sizes[i]);
        before = ", ";
    }
    if (*before == ',')
        putchar('\n');
}

static void print_text(const file_facts *facts) {
    const gscl_info *info = &facts->info;
    printf("%s: %u x %u %s, %u bits, format version %u\n", facts->name, info->width, info->height,
           channels_name(info->channels), depth_of(info), info->format_version);
    printf("%u splats, %llu bytes, %.4f bits per pixel\n", info->splats, (unsigned long long)info->bytes,
           bits_per_pixel(info->bytes, info->width, info->height));
    printf("%llu evaluations of a splat at a pixel to decode, %.1f per pixel\n", (unsigned long long)info->work,
           (double)info->work / (double)info->pixels);
    printf("profile %s, blend %s", profile_words[info->profile], blend_words[info->blend]);
    if (info->shape_words || info->colour_words)
        printf(", code words: %u shapes, %u colours", info->shape_words, info->colour_words);
    if (info->layers > 1)
        printf(", progressive: %u layers", info->layers);
    if (info->packets > 0)
        printf(", %u packet%s", info->packets, info->packets == 1 ? "" : "s");
    putchar('\n');
    print_blocks(facts);
    print_effects(facts);
    print_streams(info);
}

static void write_streams(json_writer *json, const gscl_info *info) {
    json_open_array(json, "streams");
    for (size_t i = 0; i < info->stream_count; i++) {
        json_open_object(json, NULL);
        json_string(json, "name", info->streams[i].name);
        json_real(json, "bits", info->streams[i].bits);
        json_real(json, "bytes", info->streams[i].bits / 8.0);
        json_real(json, "bits_per_splat", bits_per_splat(info, info->streams[i].bits));
        json_close_object(json);
    }
    json_close_array(json);
}

static void write_effects(json_writer *json, const file_facts *facts) {
    json_open_array(json, "effects");
    for (size_t i = 0; i < facts->use_count; i++)
        json_string(json, NULL, gscl_effect_name(facts->uses[i].effect));
    json_close_array(json);
    json_open_array(json, "effect_uses");
    for (size_t i = 0; i < facts->use_count; i++) {
        json_open_object(json, NULL);
        json_string(json, "name", gscl_effect_name(facts->uses[i].effect));
        json_real(json, "bits", facts->uses[i].bits);
        json_real(json, "gain_db", facts->uses[i].gain_db);
        json_close_object(json);
    }
    json_close_array(json);
}

static void write_blocks(json_writer *json, const file_facts *facts) {
    json_open_array(json, "blocks");
    for (size_t i = 0; i < BLOCK_TYPES; i++) {
        if (facts->block_sizes[i] == 0)
            continue;
        json_open_object(json, NULL);
        json_string(json, "name", block_names[i]);
        json_integer(json, "bytes", facts->block_sizes[i]);
        json_close_object(json);
    }
    json_close_array(json);
}

static void write_json(const file_facts *facts) {
    const gscl_info *info = &facts->info;
    json_writer json;
    json_start(&json, stdout);
    json_open_object(&json, NULL);
    json_string(&json, "file", facts->name);
    json_integer(&json, "format_version", info->format_version);
    json_integer(&json, "width", info->width);
    json_integer(&json, "height", info->height);
    json_integer(&json, "channels", info->channels);
    json_integer(&json, "depth", depth_of(info));
    json_string(&json, "profile", profile_words[info->profile]);
    json_string(&json, "blend", blend_words[info->blend]);
    write_effects(&json, facts);
    json_integer(&json, "splats", info->splats);
    json_integer(&json, "layers", info->layers);
    json_integer(&json, "packets", info->packets);
    json_integer(&json, "shape_words", info->shape_words);
    json_integer(&json, "colour_words", info->colour_words);
    json_integer(&json, "bytes", info->bytes);
    json_real(&json, "bpp", bits_per_pixel(info->bytes, info->width, info->height));
    json_integer(&json, "pixels", info->pixels);
    json_integer(&json, "work", info->work);
    write_blocks(&json, facts);
    write_streams(&json, info);
    json_close_object(&json);
}

/* Reads the image that was encoded, with its own colours where the file has them. */
static bool read_reference(const file_facts *facts, const char *reference, gscl_image *image) {
    const image_read_options options = {
        .keep_profile = facts->block_sizes[GSCL_BLOCK_COLOUR_SPACE] > 0 || facts->block_sizes[GSCL_BLOCK_ICC] > 0,
    };
    image_metadata metadata;
    if (!image_read_with(reference, &options, image, &metadata))
        return false;
    image_metadata_free(&metadata);
    return true;
}

/* Measures the gains of the effects against the image that was encoded.  Returns the exit code. */
static int inspect_against(file_facts *facts, const char *reference, const uint8_t *bytes, size_t size,
                           const gscl_read_settings *reading, const device_choice *device) {
    gscl_image image = {0};
    gscl_context *context = NULL;
    int status = EXIT_FAILURE;
    if (!read_reference(facts, reference, &image))
        return status;
    if (image.width != facts->info.width || image.height != facts->info.height ||
        image.channels != facts->info.channels)
        report_error(reference, "is %u x %u %s but %s holds %u x %u %s; give the image that was encoded", image.width,
                     image.height, channels_name(image.channels), facts->name, facts->info.width, facts->info.height,
                     channels_name(facts->info.channels));
    else if ((status = open_device(device, &context)) == EXIT_SUCCESS) {
        const gscl_result result =
            gscl_inspect_effects(context, bytes, size, reading, &image, facts->uses, &facts->use_count);
        if (result != GSCL_OK)
            status = report_result(context, facts->name, result);
    }
    gscl_context_free(&context);
    free(image.pixels);
    return status;
}

static gscl_result find_blocks(file_facts *facts, const uint8_t *bytes, size_t size) {
    gscl_result result = GSCL_OK;
    for (size_t i = 0; i < BLOCK_TYPES && result == GSCL_OK; i++) {
        const void *content;
        result = gscl_find_block(bytes, size, (gscl_block_type)i, &content, &facts->block_sizes[i]);
    }
    return result;
}

static int inspect(const char *input, const char *reference, const gscl_form *form, const gscl_limits *limits,
                   const device_choice *device, bool as_json) {
    file_facts facts = {.name = input_label(input), .info = {.struct_size = sizeof facts.info}};
    const gscl_read_settings reading = read_settings_of(form);
    uint8_t *bytes;
    size_t size;
    if (!read_gscl_file(input, form, &bytes, &size))
        return EXIT_FAILURE;
    gscl_result result = gscl_inspect(bytes, size, &reading, &facts.info);
    if (result == GSCL_OK && !form->bare)
        result = find_blocks(&facts, bytes, size);
    if (result == GSCL_OK && !reference)
        result = gscl_inspect_effects(NULL, bytes, size, &reading, NULL, facts.uses, &facts.use_count);
    int status = result == GSCL_OK ? EXIT_SUCCESS : report_result(NULL, facts.name, result);
    if (status == EXIT_SUCCESS && reference)
        status = is_within_limits(facts.name, &facts.info, limits)
                     ? inspect_against(&facts, reference, bytes, size, &reading, device)
                     : EXIT_FAILURE;
    free(bytes);
    if (status != EXIT_SUCCESS)
        return status;
    if (as_json)
        write_json(&facts);
    else
        print_text(&facts);
    return EXIT_SUCCESS;
}

int command_info(int argc, char **argv) {
    bool as_json = false;
    const char *reference = NULL;
    gscl_form form = {.bare = false};
    gscl_limits limits = GSCL_DEFAULT_LIMITS;
    device_choice device = {0};
    const option_spec options[] = {
        {.name = "reference",
         .kind = OPTION_TEXT,
         .value = &reference,
         .argument = "IMAGE",
         .help = "the image that was encoded; adds the loss in PSNR of the same splats without each effect"},
        GSCL_LIMIT_OPTIONS(limits),
        GSCL_FORM_OPTIONS(form),
        DEVICE_OPTIONS(device),
        {.name = "json", .kind = OPTION_FLAG, .value = &as_json, .help = "write JSON; null stands for unknown figures"},
    };
    const option_command command = {
        .name = "info",
        .usage = "IN.gscl [--reference IMAGE] [--json]",
        .about = "Checks a gscl file and shows its header, its blocks, its effects with the bits that the same splats "
                 "save without "
                 "each,\n"
                 "and the bits of each stream.  Only --reference draws, which the limits are for.",
        .options = options,
        .option_count = sizeof options / sizeof *options,
        .min_operands = 1,
        .max_operands = 1,
    };
    int first;
    const option_outcome outcome = options_parse(&command, argc, argv, &first);
    if (outcome != OPTIONS_RUN)
        return options_exit_code(outcome);
    return inspect(argv[first], reference, &form, &limits, &device, as_json);
}
