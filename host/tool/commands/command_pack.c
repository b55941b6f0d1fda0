/* gscl pack: splats that another program has fitted, as a gscl file. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gscl/gscl.h>

#include "cli/device_choice.h"
#include "cli/exit_code.h"
#include "cli/json.h"
#include "cli/message.h"
#include "cli/names.h"
#include "cli/options.h"
#include "cli/output_file.h"
#include "cli/progress.h"
#include "cli/rate.h"
#include "cli/read_file.h"
#include "commands/command.h"
#include "commands/field_file.h"
#include "image/image_file.h"

typedef struct pack_options {
    const char *input, *output, *reference, *background;
    option_size size;
    int blend; /* gscl_blend; AUTO: that of the file */
    bool has_bytes, has_bpp, has_psnr, no_passes, bare, json, quiet;
    double bytes, bpp, psnr, tolerance;
    uint64_t refine;
    device_choice choice;
} pack_options;

/* ---- The field ----------------------------------------------------------------------------------- */

/* What the options say counts more than what the file says. */
static bool read_field(const pack_options *o, gscl_field *field) {
    const char *label = input_label(o->input);
    *field = (gscl_field){.struct_size = sizeof *field, .background = {0, 0, 0, 1}};
    if (!field_read(o->input, field))
        return false;
    if (o->size.width > 0)
        field->width = o->size.width, field->height = o->size.height;
    if (o->blend != GSCL_BLEND_AUTO)
        field->blend = (gscl_blend)o->blend;
    if (o->background) {
        field->has_mean_background = false;
        field_parse_background(o->background, field->background);
    }
    if (field->width == 0 || field->height == 0)
        return report_error(label, "does not say the size of its picture; add --size WIDTHxHEIGHT");
    if (field->blend == GSCL_BLEND_AUTO)
        return report_error(label, "does not say how its splats are blended; add --blend normalized, alpha or sum");
    return true;
}

/* ---- Results -------------------------------------------------------------------------------------- */

static void write_json(const pack_options *o, const gscl_field *field, const gscl_pack_report *r) {
    json_writer json;
    json_start(&json, stdout);
    json_open_object(&json, NULL);
    json_string(&json, "input", input_label(o->input));
    json_string(&json, "output", o->output);
    json_integer(&json, "bytes", r->bytes);
    json_real(&json, "bpp", bits_per_pixel(r->bytes, field->width, field->height));
    json_integer(&json, "splats", r->splats);
    json_integer(&json, "field_splats", field->count);
    json_integer(&json, "outside", r->outside);
    json_integer(&json, "divided", r->divided);
    json_integer(&json, "changed", r->changed);
    json_real(&json, "changed_psnr", r->changed_psnr);
    json_real(&json, "field_psnr", r->field_psnr);
    json_real(&json, "psnr", r->psnr);
    json_real(&json, "position_error", r->position_error);
    json_real(&json, "axis_error", r->axis_error);
    json_real(&json, "colour_error", r->colour_error);
    json_real(&json, "seconds", r->seconds);
    json_close_object(&json);
}

static void print_notes(const pack_options *o, const gscl_field *field, const gscl_pack_report *r) {
    report_note("%s: %llu bytes, %.3f bits per pixel, %llu of %zu splats, %.2f dB against %s", o->output,
                (unsigned long long)r->bytes, bits_per_pixel(r->bytes, field->width, field->height),
                (unsigned long long)r->splats, field->count, r->psnr,
                o->reference ? o->reference : "the field's own picture");
    if (!isnan(r->position_error))
        report_note("largest errors: %.2f pixels of a centre, %.1f %% of an axis, %.4f of a colour", r->position_error,
                    100 * r->axis_error, r->colour_error);
    if (r->outside + r->divided + r->changed > 0)
        report_note("%llu splats outside, %llu divided into several, %llu changed to what the format has (%.1f dB)",
                    (unsigned long long)r->outside, (unsigned long long)r->divided, (unsigned long long)r->changed,
                    r->changed_psnr);
}

/* ---- The command ------------------------------------------------------------------------------------ */

static gscl_pack_settings settings_of(const pack_options *o, const gscl_image *reference) {
    gscl_pack_settings settings;
    gscl_pack_settings_default(&settings);
    settings.target = o->has_bytes  ? GSCL_TARGET_BYTES
                      : o->has_bpp  ? GSCL_TARGET_BPP
                      : o->has_psnr ? GSCL_TARGET_PSNR
                                    : GSCL_TARGET_AUTO;
    settings.target_value = o->has_bytes ? o->bytes : o->has_bpp ? o->bpp : o->has_psnr ? o->psnr : 0;
    settings.passes = !o->no_passes;
    settings.refine = (int)o->refine;
    settings.reference = o->reference ? reference : NULL;
    settings.tolerance = o->tolerance;
    settings.bare = o->bare;
    return settings;
}

static int pack_to(const pack_options *o, gscl_context *context, const gscl_field *field, const gscl_image *reference,
                   output_file *output) {
    gscl_pack_settings settings = settings_of(o, reference);
    gscl_pack_report report = {.struct_size = sizeof report};
    progress_line line;
    uint8_t *bytes;
    size_t size;
    progress_start(&line, input_label(o->input), o->quiet || o->choice.verbose);
    settings.progress = progress_update;
    settings.progress_opaque = &line;
    const gscl_result result = gscl_pack(context, field, &settings, &bytes, &size, &report);
    progress_finish(&line);
    if (result != GSCL_OK) {
        output_discard(output);
        return report_result(context, input_label(o->input), result);
    }
    output_write(output, bytes, size);
    gscl_free(bytes);
    if (!output_commit(output))
        return EXIT_FAILURE;
    if (o->json)
        write_json(o, field, &report);
    else if (!o->quiet)
        print_notes(o, field, &report);
    return EXIT_SUCCESS;
}

static int pack_field(const pack_options *o, const gscl_field *field, const gscl_image *reference) {
    gscl_context *context;
    output_file output;
    int status = open_device(&o->choice, &context);
    if (status != EXIT_SUCCESS)
        return status;
    status = output_open(&output, o->output) ? pack_to(o, context, field, reference, &output) : EXIT_FAILURE;
    gscl_context_free(&context);
    return status;
}

static int pack_file(const pack_options *o) {
    gscl_field field;
    gscl_image reference = {0};
    int status = EXIT_FAILURE;
    if (!output_is_separate("pack", o->input, o->output))
        return EXIT_USAGE;
    if (read_field(o, &field) && (!o->reference || image_read(o->reference, &reference)))
        status = pack_field(o, &field, &reference);
    free(reference.pixels);
    gscl_free(field.splats);
    return status;
}

/* Contradictions between options.  Returns 0 or EXIT_USAGE. */
static int check_options(const pack_options *o) {
    float background[4];
    if (!o->output)
        return report_usage("pack", "-o is missing; it names the file to write, or - for standard output");
    if (o->has_bytes + o->has_bpp + o->has_psnr > 1)
        return report_usage("pack", "--bytes, --bpp and --psnr exclude each other; give one of them");
    if ((o->size.width == 0) != (o->size.height == 0))
        return report_usage("pack", "--size needs both sides, WIDTHxHEIGHT");
    if (o->background && !field_parse_background(o->background, background))
        return report_usage(
            "pack", "--background cannot be '%s'; it is red,green,blue or red,green,blue,alpha or grey, each 0 to 1",
            o->background);
    if (o->json && strcmp(o->output, "-") == 0)
        return report_usage("pack", "--json and the file cannot both go to standard output");
    return 0;
}

int command_pack(int argc, char **argv) {
    pack_options pack = {.tolerance = 0.01};
    const option_spec options[] = {
        {.name = "output",
         .letter = 'o',
         .kind = OPTION_TEXT,
         .value = &pack.output,
         .argument = "FILE",
         .help = "file to write; - is standard output (required)"},
        {.name = "bytes",
         .kind = OPTION_REAL,
         .value = &pack.bytes,
         .given = &pack.has_bytes,
         .argument = "N",
         .max_real = (double)GSCL_MAX_TARGET_BYTES,
         .help = "at most so many bytes (default: the finest steps that the format has; those of the file, where it "
                 "says them)"},
        {.name = "bpp",
         .kind = OPTION_REAL,
         .value = &pack.bpp,
         .given = &pack.has_bpp,
         .argument = "R",
         .max_real = GSCL_MAX_TARGET_BPP,
         .help = "at most so many bits per pixel"},
        {.name = "psnr",
         .kind = OPTION_REAL,
         .value = &pack.psnr,
         .given = &pack.has_psnr,
         .argument = "DB",
         .max_real = GSCL_MAX_TARGET_PSNR,
         .help = "the fewest bytes with this PSNR against the reference"},
        {.name = "reference",
         .kind = OPTION_TEXT,
         .value = &pack.reference,
         .argument = "IMAGE",
         .help = "image that PSNR and passes compare with (default: the field's own picture)"},
        {.name = "no-passes",
         .kind = OPTION_FLAG,
         .value = &pack.no_passes,
         .help = "keep all splats, in coarser steps: faster, and larger at the same quality"},
        {.name = "refine",
         .kind = OPTION_INTEGER,
         .value = &pack.refine,
         .argument = "N",
         .max_integer = GSCL_MAX_REFINE,
         .help = "let the splats move towards the reference, as long as an encode of effort N does (default 0: not at "
                 "all)"},
        {.name = "tolerance",
         .kind = OPTION_REAL,
         .value = &pack.tolerance,
         .argument = "T",
         .max_real = 1,
         .help = "root mean square of the difference that splats may make which the format has not, 0 to 1 (default "
                 "0.01, 40 dB)"},
        {.name = "size",
         .kind = OPTION_SIZE,
         .value = &pack.size,
         .argument = "WxH",
         .max_integer = GSCL_MAX_DIMENSION,
         .help = "size of the picture in pixels (default: that in the file)"},
        {.name = "blend",
         .kind = OPTION_WORD,
         .value = &pack.blend,
         .words = blend_words,
         .argument = "B",
         .help = "how the colours of splats are combined (default: auto, as the file says)"},
        {.name = "background",
         .kind = OPTION_TEXT,
         .value = &pack.background,
         .argument = "R,G,B",
         .help = "background, each 0 to 1 (default: that in the file, or black)"},
        {.name = "bare",
         .kind = OPTION_FLAG,
         .value = &pack.bare,
         .help = "write the picture alone, as gscl encode --bare"},
        {.name = "json", .kind = OPTION_FLAG, .value = &pack.json, .help = "print the results as JSON"},
        {.name = "quiet", .letter = 'q', .kind = OPTION_FLAG, .value = &pack.quiet, .help = "print errors only"},
        DEVICE_OPTIONS(pack.choice),
    };
    const option_command command = {
        .name = "pack",
        .usage = "FIELD -o OUT.gscl [options]",
        .about = "Writes splats that another program has fitted as a gscl file.  FIELD is a table, CSV or PLY, with a "
                 "row for each\n"
                 "splat: x, y (centre); sigma1, sigma2, theta (standard deviations and the direction of the first, "
                 "radians from +x\n"
                 "towards +y, which points down), or cov_xx, cov_xy, cov_yy (covariance), or l11, l21, l22 (its "
                 "Cholesky factor), all\n"
                 "in pixels; red, green, blue or grey, and alpha, from 0 to 1; opacity or weight; and the other "
                 "columns that\n"
                 "gscl export writes.  It may be a gscl file, too.",
        .options = options,
        .option_count = sizeof options / sizeof *options,
        .min_operands = 1,
        .max_operands = 1,
    };
    int first;
    const option_outcome outcome = options_parse(&command, argc, argv, &first);
    if (outcome != OPTIONS_RUN)
        return options_exit_code(outcome);
    if (check_options(&pack) != 0)
        return EXIT_USAGE;
    pack.input = argv[first];
    pack.choice.quiet = pack.quiet;
    return pack_file(&pack);
}
