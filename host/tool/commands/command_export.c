/* gscl export: the splats of a file as an SVG image, or as a table. */
#define _DEFAULT_SOURCE /* strcasecmp */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <gscl/gscl.h>

#include "cli/device_choice.h"
#include "cli/exit_code.h"
#include "cli/gscl_input.h"
#include "cli/message.h"
#include "cli/names.h"
#include "cli/options.h"
#include "cli/output_file.h"
#include "cli/progress.h"
#include "cli/read_file.h"
#include "commands/command.h"
#include "commands/export_svg.h"

typedef enum export_format { EXPORT_SVG, EXPORT_PLY, EXPORT_CSV, EXPORT_FORMATS } export_format;
static const char *const suffixes[] = {".svg", ".ply", ".csv"};

typedef struct export_options {
    const char *input, *output;
    bool formats[EXPORT_FORMATS]; /* which were asked for */
    export_format format;
    gscl_form form;
    gscl_limits limits; /* of an SVG image */
} export_options;

/* ---- Tables ------------------------------------------------------------------------------------ */

static const char *const columns[] = {"x",       "y",      "sigma1",     "sigma2",         "theta",
                                      "opacity", "red",    "green",      "blue",           "alpha",
                                      "wave_x",  "wave_y", "wave_phase", "wave_amplitude", "layer"};
#define COLUMN_COUNT (sizeof columns / sizeof *columns)

/* What is needed to draw the splats besides, as one line that gscl pack reads. */
static void write_description(output_file *output, const gscl_field *f) {
    char text[512];
    int length =
        snprintf(text, sizeof text,
                 "comment gscl width=%u height=%u channels=%u bits=%d blend=%s background=%.9g,%.9g,%.9g,%.9g%s "
                 "cutoff=%g background_weight=%.9g largest_alpha=%g",
                 f->width, f->height, f->channels, f->sample == GSCL_SAMPLE_U8 ? 8 : 16, blend_words[f->blend],
                 (double)f->background[0], (double)f->background[1], (double)f->background[2], (double)f->background[3],
                 f->has_mean_background ? " mean" : "", GSCL_SPLAT_CUTOFF, GSCL_BACKGROUND_WEIGHT, GSCL_LARGEST_ALPHA);
    output_write(output, text, (size_t)length);
    const gscl_steps *s = &f->steps;
    length = f->has_steps ? snprintf(text, sizeof text, " steps=%u,%u,%u,%u,%u,%u,%u,%u", s->scale, s->position,
                                     s->angle, s->luma, s->chroma, s->alpha, s->opacity, s->pivot)
                          : 0;
    output_write(output, text, (size_t)length);
    output_write(output, "\n", 1);
}

static void write_ply_head(output_file *output, const gscl_field *field) {
    char text[256];
    int length = snprintf(text, sizeof text, "ply\nformat ascii 1.0\n");
    output_write(output, text, (size_t)length);
    write_description(output, field);
    length = snprintf(
        text, sizeof text,
        "comment y points down; theta: radians from +x towards +y; colours premultiplied\nelement vertex %zu\n",
        field->count);
    output_write(output, text, (size_t)length);
    for (size_t i = 0; i < COLUMN_COUNT; i++) {
        length = snprintf(text, sizeof text, "property %s %s\n%s", i + 1 < COLUMN_COUNT ? "float" : "uchar", columns[i],
                          i == 1 ? "property float z\n" : "");
        output_write(output, text, (size_t)length);
    }
    output_write(output, "end_header\n", 11);
}

static void write_csv_head(output_file *output) {
    for (size_t i = 0; i < COLUMN_COUNT; i++) {
        output_write(output, columns[i], strlen(columns[i]));
        output_write(output, i + 1 < COLUMN_COUNT ? "," : "\n", 1);
    }
}

static void write_table(const export_options *options, output_file *output, const gscl_field *field) {
    const bool ply = options->format == EXPORT_PLY;
    const char *format = ply ? "%.9g %.9g 0 %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %u\n"
                             : "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%u\n";
    if (ply)
        write_ply_head(output, field);
    else
        write_csv_head(output);
    for (size_t i = 0; i < field->count && !output->error; i++) {
        const gscl_splat *s = &field->splats[i];
        char text[320];
        const int length = snprintf(text, sizeof text, format, s->x, s->y, s->sigma1, s->sigma2, s->theta, s->opacity,
                                    s->colour[0], s->colour[1], s->colour[2], s->colour[3], s->wave_x, s->wave_y,
                                    s->wave_phase, s->wave_amplitude, s->layer);
        output_write(output, text, (size_t)length);
    }
}

/* ---- SVG --------------------------------------------------------------------------------------- */

static gscl_decode_settings svg_settings(const export_options *options, const gscl_info *info) {
    gscl_decode_settings settings;
    gscl_decode_settings_default(&settings);
    settings.sample = GSCL_SAMPLE_F32;
    settings.layout = GSCL_LAYOUT_RGB; /* transparent parts over black, so that colours are multiplied by alpha */
    settings.bare = options->form.bare;
    settings.max_pixels = options->limits.max_pixels;
    settings.max_work = options->limits.max_work;
    export_svg_grid(info, &settings.width, &settings.height);
    return settings;
}

/* Drawing the picture comes first: it refuses files that would take too long here, too. */
static int write_svg(const export_options *options, output_file *output, const gscl_info *info, const uint8_t *bytes,
                     size_t size, const gscl_field *field) {
    const device_choice choice = {.device = GSCL_HOST_DEVICE};
    gscl_decode_settings settings = svg_settings(options, info);
    const char *label = input_label(options->input);
    gscl_context *context;
    gscl_image image = {0};
    int status = open_device(&choice, &context);
    if (status != EXIT_SUCCESS)
        return status;
    const gscl_result result = progress_decode(context, label, bytes, size, &settings, &image);
    if (result != GSCL_OK)
        status = report_result(context, label, result);
    else if (!export_svg(output, info, field->splats, field->count, &image))
        status = report_result(NULL, label, GSCL_ERROR_OUT_OF_MEMORY);
    gscl_free(image.pixels);
    gscl_context_free(&context);
    return status;
}

/* ---- The command ------------------------------------------------------------------------------- */

static int export_splats(const export_options *options, const gscl_info *info, const uint8_t *bytes, size_t size,
                         const gscl_field *field) {
    output_file output;
    int status = EXIT_SUCCESS;
    if (!output_open_text(&output, options->output))
        return EXIT_FAILURE;
    if (options->format == EXPORT_SVG)
        status = write_svg(options, &output, info, bytes, size, field);
    else
        write_table(options, &output, field);
    if (status == EXIT_SUCCESS)
        return output_commit(&output) ? EXIT_SUCCESS : EXIT_FAILURE;
    output_discard(&output);
    return status;
}

static int export_file(const export_options *options) {
    gscl_info info = {.struct_size = sizeof info};
    gscl_field field = {.struct_size = sizeof field};
    size_t size;
    uint8_t *bytes;
    if (!output_is_separate("export", options->input, options->output))
        return EXIT_USAGE;
    if (!read_gscl_file(options->input, &options->form, &bytes, &size))
        return EXIT_FAILURE;
    const gscl_read_settings reading = read_settings_of(&options->form);
    gscl_result result = gscl_probe(bytes, size, &reading, &info);
    if (result == GSCL_OK)
        result = gscl_read_field(bytes, size, &reading, &field);
    const int status = result == GSCL_OK ? export_splats(options, &info, bytes, size, &field)
                                         : report_result(NULL, input_label(options->input), result);
    gscl_free(field.splats);
    free(bytes);
    return status;
}

/* The format of the options, or that of the suffix.  Returns 0 or EXIT_USAGE. */
static int choose_format(export_options *options) {
    const int asked = options->formats[EXPORT_SVG] + options->formats[EXPORT_PLY] + options->formats[EXPORT_CSV];
    if (!options->output)
        return report_usage("export", "-o is missing; it names the file to write, or - for standard output");
    if (asked > 1)
        return report_usage("export", "--svg, --ply and --csv exclude each other; give one of them");
    for (int i = 0; i < EXPORT_FORMATS; i++) {
        if (asked ? options->formats[i] : strcasecmp(name_suffix(options->output), suffixes[i]) == 0) {
            options->format = (export_format)i;
            return 0;
        }
    }
    return report_usage("export", "%s: the format is not known by its name; add --svg, --ply or --csv",
                        options->output);
}

int command_export(int argc, char **argv) {
    export_options export = {.limits = GSCL_DEFAULT_LIMITS};
    const option_spec options[] = {
        {.name = "output",
         .letter = 'o',
         .kind = OPTION_TEXT,
         .value = &export.output,
         .argument = "FILE",
         .help = "file to write, in the format of its suffix; - is standard output (required)"},
        {.name = "svg",
         .kind = OPTION_FLAG,
         .value = &export.formats[EXPORT_SVG],
         .help = "write an SVG image: an approximation of the picture, without waves and transparency"},
        {.name = "ply",
         .kind = OPTION_FLAG,
         .value = &export.formats[EXPORT_PLY],
         .help = "write a PLY point cloud in text form, with z 0"},
        {.name = "csv",
         .kind = OPTION_FLAG,
         .value = &export.formats[EXPORT_CSV],
         .help = "write a table with a line for each splat"},
        GSCL_FORM_OPTIONS(export.form),
        GSCL_LIMIT_OPTIONS(export.limits),
    };
    const option_command command = {
        .name = "export",
        .usage = "IN.gscl -o OUT.svg|OUT.ply|OUT.csv [options]",
        .about =
            "Writes the splats of a gscl file for other programs.  SVG draws each as an ellipse with a radial "
            "gradient.  It\ncan be scaled without limit but only comes close to the picture: SVG cannot blend as gscl "
            "does.\n\nPLY and CSV have the splats in drawing order, in the columns x, y (centre) and sigma1, sigma2 "
            "(standard\n"
            "deviations) in pixels of the encoded size, theta (direction of sigma1) in radians from +x towards +y, "
            "which\npoints "
            "down, opacity, red, green, blue, alpha from 0 to 1; colours are multiplied by alpha, and those of "
            "the\nblend sum may "
            "be negative; then the wave: cycles per pixel along x and y, phase in cycles, amplitude; and the\nlayer.  "
            "PLY has "
            "what else it takes to draw them in a comment that begins with gscl: size, blend, background and\nmore.  "
            "gscl pack "
            "makes a gscl file of either.",
        .options = options,
        .option_count = sizeof options / sizeof *options,
        .min_operands = 1,
        .max_operands = 1,
    };
    int first;
    const option_outcome outcome = options_parse(&command, argc, argv, &first);
    if (outcome != OPTIONS_RUN)
        return options_exit_code(outcome);
    if (choose_format(&export) != 0)
        return EXIT_USAGE;
    export.input = argv[first];
    return export_file(&export);
}
