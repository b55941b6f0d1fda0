/* gscl decode: decodes a gscl file to an image. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gscl/gscl.h>

#include "cli/device_choice.h"
#include "cli/exit_code.h"
#include "cli/gscl_input.h"
#include "cli/message.h"
#include "cli/options.h"
#include "cli/progress.h"
#include "cli/read_file.h"
#include "commands/command.h"
#include "host/system/files.h"
#include "image/image_alpha.h"
#include "image/image_file.h"
#include "image/image_format.h"
#include "image/image_output.h"

typedef struct decode_options {
    const char *input, *output; /* the input that messages name */
    char *const *inputs;
    int input_count;
    double scale;
    option_size size;
    option_rectangle crop;
    int depth; /* index into depth_words */
    gscl_limits limits;
    option_colour background;
    bool has_scale, has_size, has_crop, has_depth, has_background;
    bool partial;
    gscl_form form;
    device_choice choice;
} decode_options;

static const char *const depth_words[] = {"8", "16", NULL};

static uint32_t scaled(uint32_t length, double scale) {
    const double value = floor(length * scale + 0.5);
    return value < 1.0 ? 1 : value > GSCL_MAX_DIMENSION ? GSCL_MAX_DIMENSION + 1 : (uint32_t)value;
}

/* A side that --size leaves out keeps the aspect ratio. */
static void choose_size(const decode_options *options, const gscl_info *info, gscl_decode_settings *settings) {
    const option_size size = options->size;
    const double scale = !options->has_size ? options->scale
                         : size.width > 0   ? (double)size.width / info->width
                                            : (double)size.height / info->height;
    settings->width = size.width > 0 ? size.width : scaled(info->width, scale);
    settings->height = size.height > 0 ? size.height : scaled(info->height, scale);
}

/* Chooses the size to draw at and the crop.  Reports errors. */
static bool choose_area(const decode_options *options, const gscl_info *info, gscl_decode_settings *settings) {
    choose_size(options, info, settings);
    if (settings->width > GSCL_MAX_DIMENSION || settings->height > GSCL_MAX_DIMENSION)
        return report_error(
            input_label(options->input),
            "would be wider or higher than %d pixels; its size is %u x %u, choose a smaller scale or size",
            GSCL_MAX_DIMENSION, info->width, info->height);
    if (!options->has_crop)
        return true;
    const option_rectangle *crop = &options->crop;
    if (crop->x + crop->width > settings->width || crop->y + crop->height > settings->height)
        return report_error(input_label(options->input), "has no area %u,%u,%u,%u; the image is %u x %u pixels",
                            crop->x, crop->y, crop->width, crop->height, settings->width, settings->height);
    settings->crop_x = crop->x;
    settings->crop_y = crop->y;
    settings->crop_width = crop->width;
    settings->crop_height = crop->height;
    return true;
}

/* The sample type: that of the output format if it has only one, else that of --depth, else that of the file. */
static gscl_sample choose_sample(const decode_options *options, const image_format *format, const gscl_info *info) {
    if (format->bits == 32)
        return GSCL_SAMPLE_F32;
    if (options->has_depth)
        return strcmp(depth_words[options->depth], "16") == 0 ? GSCL_SAMPLE_U16 : GSCL_SAMPLE_U8;
    return info->sample;
}

/* Copies a block of the file.  Returns false without memory. */
static bool copy_block(const uint8_t *bytes, size_t size, gscl_block_type type, image_blob *blob) {
    const void *data;
    size_t data_size;
    return gscl_find_block(bytes, size, type, &data, &data_size) != GSCL_OK || image_blob_set(blob, data, data_size);
}

/* Copies what the file holds beside the picture.  Reports errors. */
static bool copy_metadata(const decode_options *options, const uint8_t *bytes, size_t size, image_metadata *metadata) {
    image_blob cicp = {0};
    if (options->form.bare)
        return true;
    const bool ok = copy_block(bytes, size, GSCL_BLOCK_COLOUR_SPACE, &cicp) &&
                    copy_block(bytes, size, GSCL_BLOCK_ICC, &metadata->icc) &&
                    copy_block(bytes, size, GSCL_BLOCK_EXIF, &metadata->exif) &&
                    copy_block(bytes, size, GSCL_BLOCK_XMP, &metadata->xmp);
    metadata->has_cicp = cicp.size == sizeof metadata->cicp;
    if (metadata->has_cicp)
        memcpy(metadata->cicp, cicp.bytes, sizeof metadata->cicp);
    image_blob_free(&cicp);
    return ok || report_error(input_label(options->input), "%s", gscl_result_text(GSCL_ERROR_OUT_OF_MEMORY));
}

/* NULL without --background. */
static const option_colour *background_of(const decode_options *options) {
    return options->has_background ? &options->background : NULL;
}

/* Writes the decoded image, with what the file holds beside it.  The output is closed in any case. */
static int write_decoded(const decode_options *options, const image_format *format, const uint8_t *bytes, size_t size,
                         gscl_image *image, output_file *output) {
    image_metadata metadata = {0};
    gscl_image flat = {0};
    const bool on_background = options->has_background && image->channels % 2 == 0;
    bool ok = copy_metadata(options, bytes, size, &metadata) &&
              image_prepare_output(output->label, format, on_background, options->choice.verbose, image, &metadata) &&
              image_flatten(output->label, format, background_of(options), image, &flat);
    if (ok)
        ok = image_write_with(output, flat.pixels ? &flat : image, &metadata);
    else
        output_discard(output);
    free(flat.pixels);
    image_metadata_free(&metadata);
    return ok ? EXIT_SUCCESS : EXIT_FAILURE;
}

/* Pixels that the decode returns. */
static uint64_t pixels_of(const gscl_decode_settings *settings) {
    const bool cropped = settings->crop_width > 0;
    return (uint64_t)(cropped ? settings->crop_width : settings->width) *
           (cropped ? settings->crop_height : settings->height);
}

/* Decodes the file and writes the image to `output`, which is closed in any case. */
static int decode_to(const decode_options *options, const image_format *format, const uint8_t *bytes, size_t size,
                     gscl_decode_settings *settings, output_file *output) {
    gscl_context *context;
    gscl_image image = {0};
    int status = open_decoder(&options->choice, pixels_of(settings), &context);
    if (status == EXIT_SUCCESS) {
        const gscl_result result = progress_decode(context, input_label(options->input), bytes, size, settings, &image);
        if (result != GSCL_OK)
            status = report_result(context, input_label(options->input), result);
        gscl_context_free(&context);
    }
    if (status == EXIT_SUCCESS)
        status = write_decoded(options, format, bytes, size, &image, output);
    else
        output_discard(output);
    gscl_free(image.pixels);
    return status;
}

static int decode_bytes(const decode_options *options, const image_format *format, const uint8_t *bytes, size_t size) {
    gscl_info info = {.struct_size = sizeof info};
    gscl_decode_settings settings;
    output_file output;
    const gscl_read_settings reading = read_settings_of(&options->form);
    const gscl_result result = gscl_probe(bytes, size, &reading, &info);
    if (result != GSCL_OK)
        return report_result(NULL, input_label(options->input), result);
    gscl_decode_settings_default(&settings);
    settings.sample = choose_sample(options, format, &info);
    settings.max_pixels = options->limits.max_pixels;
    settings.max_work = options->limits.max_work;
    settings.bare = options->form.bare;
    settings.partial = options->partial;
    const unsigned channels = image_written_channels(info.channels, format, background_of(options));
    if (!choose_area(options, &info, &settings) ||
        !image_format_holds(format, options->output, channels, settings.sample) ||
        !output_open(&output, options->output))
        return EXIT_FAILURE;
    return decode_to(options, format, bytes, size, &settings, &output);
}

static int decode_file(const decode_options *options) {
    const image_format *format = image_format_of("decode", options->output);
    if (!format)
        return EXIT_USAGE;
    for (int i = 0; i < options->input_count; i++)
        if (!output_is_separate("decode", options->inputs[i], options->output))
            return EXIT_USAGE;
    if (format->bits == 32 && options->has_depth)
        return report_usage("decode", "--depth does not apply to %s, which holds floating-point samples; leave it out",
                            format->suffix);
    uint8_t *bytes;
    size_t size;
    if (!read_gscl_files(options->inputs, options->input_count, &options->form, &bytes, &size))
        return EXIT_FAILURE;
    const int status = decode_bytes(options, format, bytes, size);
    free(bytes);
    return status;
}

/* Whether the last of several operands names an image: without -o it is the output. */
static bool has_output_operand(const decode_options *decode) {
    return !decode->output && decode->input_count > 1 &&
           image_format_has_suffix(decode->inputs[decode->input_count - 1]);
}

static option_outcome parse_decode(decode_options *decode, int argc, char **argv) {
    const option_spec options[] = {
        {.name = "output",
         .letter = 'o',
         .kind = OPTION_TEXT,
         .value = &decode->output,
         .argument = "FILE",
         .help = "image to write, in the format of its suffix, PNG where a pipe has none; - is standard output "
                 "(default: the last operand, where it has the suffix of an image and does not exist)"},
        {.name = "scale",
         .kind = OPTION_REAL,
         .value = &decode->scale,
         .given = &decode->has_scale,
         .argument = "F",
         .min_real = 0.001,
         .max_real = GSCL_MAX_DIMENSION,
         .help = "draw at this multiple of the encoded size (default 1)"},
        {.name = "size",
         .kind = OPTION_SIZE,
         .value = &decode->size,
         .given = &decode->has_size,
         .argument = "WxH",
         .max_integer = GSCL_MAX_DIMENSION,
         .help = "draw at this size; W or xH alone keeps the aspect ratio (default: as encoded)"},
        {.name = "crop",
         .kind = OPTION_RECTANGLE,
         .value = &decode->crop,
         .given = &decode->has_crop,
         .argument = "X,Y,W,H",
         .max_integer = GSCL_MAX_DIMENSION,
         .help = "write only this part of the drawn image"},
        {.name = "depth",
         .kind = OPTION_WORD,
         .value = &decode->depth,
         .given = &decode->has_depth,
         .argument = "N",
         .words = depth_words,
         .help = "bits per sample (default: those of the encoded image)"},
        {.name = "background",
         .kind = OPTION_COLOUR,
         .value = &decode->background,
         .given = &decode->has_background,
         .argument = "COLOUR",
         .help = "draw a picture with alpha over this colour, and write no alpha (default: keep it)"},
        GSCL_LIMIT_OPTIONS(decode->limits),
        {.name = "partial",
         .kind = OPTION_FLAG,
         .value = &decode->partial,
         .help = "draw what has come of a file that is cut off (default: refuse it)"},
        GSCL_FORM_OPTIONS(decode->form),
        DEVICE_OPTIONS(decode->choice),
        {.name = "verbose",
         .letter = 'v',
         .kind = OPTION_FLAG,
         .value = &decode->choice.verbose,
         .help = "print on standard error what was written beside the pixels, and messages of the library"},
    };
    const option_command command = {
        .name = "decode",
        .usage = "IN... [-o] OUT.png [options]",
        .about =
            "Decodes a gscl file, or packets of 'gscl encode --packets' in any order and with any of them missing, to "
            "an image, with the colour profile, EXIF and XMP that the file has, where the "
            "format holds\nthem; colours are converted to sRGB otherwise.  Alpha is written straight; OpenEXR holds "
            "premultiplied alpha\nand linear light.\n\n"
            "Where the format holds no alpha (.jpg, .ppm, .bmp and others), it is left out if it is 1 everywhere; "
            "otherwise\n--background is needed.  Its colour is one of sRGB, and blends on the curve of sRGB, as in "
            "browsers; colours of\nother profiles are converted to sRGB first.  Grey over a colour becomes RGB.  The # "
            "of #rgb may be left out, as shells\ntake it for a comment.\n\n" DECODER_CHOICE_HELP,
        .options = options,
        .option_count = sizeof options / sizeof *options,
        .min_operands = 1,
        .max_operands = argc,
    };
    int first;
    const option_outcome outcome = options_parse(&command, argc, argv, &first);
    if (outcome == OPTIONS_RUN) {
        decode->inputs = argv + first;
        decode->input_count = argc - first;
        decode->input = argv[first];
    }
    return outcome;
}

int command_decode(int argc, char **argv) {
    decode_options options = {.scale = 1.0, .limits = GSCL_DEFAULT_LIMITS};
    const option_outcome outcome = parse_decode(&options, argc, argv);
    if (outcome != OPTIONS_RUN)
        return options_exit_code(outcome);
    if (has_output_operand(&options) &&
        output_take_operand("decode", options.inputs, &options.input_count, &options.output) != 0)
        return EXIT_USAGE;
    const char *last = options.inputs[options.input_count - 1];
    if (!options.output && options.input_count > 1 && !system_exists(last) && !image_format_of("decode", last))
        return EXIT_USAGE; /* an output whose suffix is none */
    if (!options.output)
        return report_usage("decode", "the output is missing; give the name of an image, or -o - for standard output");
    if (options.has_scale && options.has_size)
        return report_usage("decode", "--scale and --size exclude each other; give one of them");
    if (options.input_count > 1 && options.form.bare)
        return report_usage("decode", "a bare file is decoded alone; only packets are put together");
    return decode_file(&options);
}
