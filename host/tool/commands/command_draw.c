/* gscl draw: the splats of a file as ellipse outlines over the decoded image. */
#include <stdlib.h>

#include <gscl/gscl.h>

#include "cli/device_choice.h"
#include "cli/exit_code.h"
#include "cli/gscl_input.h"
#include "cli/message.h"
#include "cli/options.h"
#include "cli/progress.h"
#include "cli/read_file.h"
#include "commands/command.h"
#include "commands/ellipse_outline.h"
#include "image/image_alpha.h"
#include "image/image_file.h"
#include "image/image_format.h"

typedef struct draw_options {
    const char *input, *output;
    uint64_t scale;
    option_colour background;
    bool has_background;
    gscl_limits limits;
    gscl_form form;
    device_choice choice;
} draw_options;

/* NULL without --background. */
static const option_colour *background_of(const draw_options *options) {
    return options->has_background ? &options->background : NULL;
}

static gscl_result draw_outlines(const draw_options *options, const uint8_t *bytes, size_t size, const gscl_info *info,
                                 gscl_image *image) {
    gscl_field field = {.struct_size = sizeof field};
    const gscl_read_settings reading = read_settings_of(&options->form);
    const gscl_result result = gscl_read_field(bytes, size, &reading, &field);
    if (result != GSCL_OK)
        return result;
    const double scale_x = (double)image->width / info->width, scale_y = (double)image->height / info->height;
    for (size_t i = 0; i < field.count; i++)
        outline_draw(image, &field.splats[i], scale_x, scale_y);
    gscl_free(field.splats);
    return GSCL_OK;
}

static gscl_decode_settings settings_of(const draw_options *options, const gscl_info *info) {
    gscl_decode_settings settings;
    gscl_decode_settings_default(&settings);
    settings.sample = GSCL_SAMPLE_U8;
    settings.layout = info->channels % 2 == 0 ? GSCL_LAYOUT_RGBA : GSCL_LAYOUT_RGB; /* outlines have a colour */
    settings.bare = options->form.bare;
    settings.max_pixels = options->limits.max_pixels;
    settings.max_work = options->limits.max_work;
    settings.width = info->width * (uint32_t)options->scale;
    settings.height = info->height * (uint32_t)options->scale;
    return settings;
}

/* Decodes the file into *image, whose pixels are released with gscl_free.  Returns the exit code. */
static int decode(const draw_options *options, const uint8_t *bytes, size_t size, const gscl_info *info,
                  gscl_image *image) {
    gscl_context *context;
    gscl_decode_settings settings = settings_of(options, info);
    int status = open_device(&options->choice, &context);
    if (status != EXIT_SUCCESS)
        return status;
    const gscl_result result = progress_decode(context, input_label(options->input), bytes, size, &settings, image);
    if (result != GSCL_OK)
        status = report_result(context, input_label(options->input), result);
    gscl_context_free(&context);
    return status;
}

/* Decodes the file, draws the outlines and writes the image to `output`, which is closed in any case.  Returns the exit
 * code. */
static int draw_to(const draw_options *options, const image_format *format, const uint8_t *bytes, size_t size,
                   const gscl_info *info, output_file *output) {
    gscl_image decoded = {0}, flat = {0};
    int status = decode(options, bytes, size, info, &decoded);
    if (status == EXIT_SUCCESS && !image_flatten(options->output, format, background_of(options), &decoded, &flat))
        status = EXIT_FAILURE;
    gscl_image *image = flat.pixels ? &flat : &decoded;
    if (status == EXIT_SUCCESS) {
        const gscl_result result = draw_outlines(options, bytes, size, info, image);
        if (result != GSCL_OK)
            status = report_result(NULL, input_label(options->input), result);
    }
    if (status == EXIT_SUCCESS)
        status = image_write(output, image) ? EXIT_SUCCESS : EXIT_FAILURE;
    else
        output_discard(output);
    free(flat.pixels);
    gscl_free(decoded.pixels);
    return status;
}

static int draw_bytes(const draw_options *options, const image_format *format, const uint8_t *bytes, size_t size) {
    gscl_info info = {.struct_size = sizeof info};
    output_file output;
    const char *label = input_label(options->input);
    const gscl_read_settings reading = read_settings_of(&options->form);
    const gscl_result result = gscl_probe(bytes, size, &reading, &info);
    if (result != GSCL_OK)
        return report_result(NULL, label, result);
    if (info.width * options->scale > GSCL_MAX_DIMENSION || info.height * options->scale > GSCL_MAX_DIMENSION) {
        report_error(
            label, "would be wider or higher than %d pixels at this scale; its size is %u x %u, choose a smaller scale",
            GSCL_MAX_DIMENSION, info.width, info.height);
        return EXIT_FAILURE;
    }
    const bool has_alpha = image_written_channels(info.channels, format, background_of(options)) % 2 == 0;
    if (!image_format_holds(format, options->output, has_alpha ? 4 : 3, GSCL_SAMPLE_U8) ||
        !output_open(&output, options->output))
        return EXIT_FAILURE;
    return draw_to(options, format, bytes, size, &info, &output);
}

static int draw_file(const draw_options *options) {
    const image_format *format = image_format_of("draw", options->output);
    if (!format || !output_is_separate("draw", options->input, options->output))
        return EXIT_USAGE;
    uint8_t *bytes;
    size_t size;
    if (!read_gscl_file(options->input, &options->form, &bytes, &size))
        return EXIT_FAILURE;
    const int status = draw_bytes(options, format, bytes, size);
    free(bytes);
    return status;
}

int command_draw(int argc, char **argv) {
    draw_options draw = {.scale = 1, .limits = GSCL_DEFAULT_LIMITS};
    const option_spec options[] = {
        {.name = "output",
         .letter = 'o',
         .kind = OPTION_TEXT,
         .value = &draw.output,
         .argument = "FILE",
         .help =
             "image to write, in the format of its suffix, PNG where a pipe has none; - is standard output (required)"},
        {.name = "scale",
         .kind = OPTION_INTEGER,
         .value = &draw.scale,
         .argument = "N",
         .min_integer = 1,
         .max_integer = 64,
         .help = "scale of the image; the width of the lines stays (default 1)"},
        {.name = "background",
         .kind = OPTION_COLOUR,
         .value = &draw.background,
         .given = &draw.has_background,
         .argument = "COLOUR",
         .help = "draw a picture with alpha over this colour, and write no alpha (default: keep it)"},
        GSCL_LIMIT_OPTIONS(draw.limits),
        GSCL_FORM_OPTIONS(draw.form),
        DEVICE_OPTIONS(draw.choice),
    };
    const option_command command = {
        .name = "draw",
        .usage = "IN.gscl -o OUT.png [options]",
        .about = "Draws the outline of each splat, one standard deviation from its centre, over the decoded image.",
        .options = options,
        .option_count = sizeof options / sizeof *options,
        .min_operands = 1,
        .max_operands = 1,
    };
    int first;
    const option_outcome outcome = options_parse(&command, argc, argv, &first);
    if (outcome != OPTIONS_RUN)
        return options_exit_code(outcome);
    if (!draw.output)
        return report_usage("draw", "-o is missing; it names the image to write, or - for standard output");
    draw.input = argv[first];
    return draw_file(&draw);
}
