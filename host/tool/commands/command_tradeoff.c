/* gscl tradeoff: what accuracy costs in time, as tables and plots. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gscl/gscl.h>

#include "cli/exit_code.h"
#include "cli/message.h"
#include "cli/options.h"
#include "commands/command.h"
#include "image/image_file.h"
#include "tradeoff/tradeoff.h"
#include "tradeoff/tradeoff_files.h"
#include "tradeoff/tradeoff_tables.h"

#define DEFAULT_BPP 0.125
#define LEAST_BYTES 256.0 /* of the default */
#define MAX_FILE_BYTES UINT32_MAX

typedef struct tradeoff_options {
    tradeoff_plan plan;
    const char *folder;
    uint64_t bytes;
    double bpp;
    bool has_bytes, has_bpp, as_json;
} tradeoff_options;

static option_outcome parse(tradeoff_options *tradeoff, int argc, char **argv, int *first) {
    const option_spec options[] = {
        {.name = "out",
         .letter = 'o',
         .kind = OPTION_TEXT,
         .value = &tradeoff->folder,
         .argument = "DIR",
         .help = "folder for the tables (CSV, JSON) and plots (SVG, PNG), made where there is none (default tradeoff)"},
        {.name = "bytes",
         .kind = OPTION_INTEGER,
         .value = &tradeoff->bytes,
         .given = &tradeoff->has_bytes,
         .argument = "N",
         .min_integer = 1,
         .max_integer = MAX_FILE_BYTES,
         .help = "size of the files that efforts are compared at"},
        {.name = "bpp",
         .kind = OPTION_REAL,
         .value = &tradeoff->bpp,
         .given = &tradeoff->has_bpp,
         .argument = "R",
         .min_real = 0.0001,
         .max_real = 8.0,
         .help = "the same in bits per pixel (default 0.125, or 256 bytes if that is more)"},
        {.name = "effort",
         .kind = OPTION_INTEGER,
         .value = &tradeoff->plan.effort,
         .argument = "N",
         .min_integer = 0,
         .max_integer = GSCL_MAX_EFFORT,
         .help = "effort that rates are compared at (default 5)"},
        {.name = "quick",
         .kind = OPTION_FLAG,
         .value = &tradeoff->plan.quick,
         .help = "fewer efforts and rates, each measured once: rough figures, soon"},
        DEVICE_OPTIONS(tradeoff->plan.choice),
        {.name = "json", .kind = OPTION_FLAG, .value = &tradeoff->as_json, .help = "write JSON instead of tables"},
    };
    const option_command command = {
        .name = "tradeoff",
        .usage = "IMAGE [--out DIR] [--bytes N | --bpp R] [--quick] [options]",
        .about = "Measures on this machine what accuracy costs in time: quality against encode time at every effort,\n"
                 "quality against rate, the renderer's arithmetic and the fit's gradients against double precision.\n"
                 "Prints tables, and writes them and plots of them into a folder.  Takes a minute or two.",
        .options = options,
        .option_count = sizeof options / sizeof *options,
        .min_operands = 1,
        .max_operands = 1,
    };
    return options_parse(&command, argc, argv, first);
}

static uint64_t fixed_bytes(const tradeoff_options *tradeoff, const gscl_image *image) {
    const double pixels = (double)image->width * image->height;
    if (tradeoff->has_bytes)
        return tradeoff->bytes;
    return (uint64_t)(tradeoff->has_bpp ? fmax(tradeoff->bpp * pixels / 8, 1)
                                        : fmax(DEFAULT_BPP * pixels / 8, LEAST_BYTES));
}

/* Below the plots' titles. */
static void describe(const tradeoff_plan *plan, tradeoff_results *results) {
    const char *slash = strrchr(plan->picture, '/');
    snprintf(results->subtitle, sizeof results->subtitle,
             "%.60s, %ux%u pixels; %llu bytes (%.3f bits per pixel) and effort %d where nothing else is said; %.80s",
             slash ? slash + 1 : plan->picture, plan->image->width, plan->image->height,
             (unsigned long long)plan->bytes, tradeoff_bpp(plan->image, plan->bytes), (int)plan->effort,
             results->device.device_name);
}

static int measure(const tradeoff_plan *plan, tradeoff_results *results) {
    const int status = tradeoff_measure_codec(plan, results);
    if (status != EXIT_SUCCESS)
        return status;
    describe(plan, results);
    return tradeoff_measure_accuracy(plan, results);
}

static int run(const tradeoff_options *tradeoff, tradeoff_results *results) {
    tradeoff_files files;
    if (!tradeoff_files_open(&files, tradeoff->folder))
        return EXIT_FAILURE;
    const int status = measure(&tradeoff->plan, results);
    if (status != EXIT_SUCCESS) {
        tradeoff_files_discard(&files);
        return status;
    }
    if (!tradeoff_files_write(&files, &tradeoff->plan, results))
        return EXIT_FAILURE;
    if (tradeoff->as_json)
        tradeoff_write_json(&tradeoff->plan, results, stdout);
    else
        tradeoff_print(&tradeoff->plan, results);
    return EXIT_SUCCESS;
}

static int run_on(tradeoff_options *tradeoff, const gscl_image *image) {
    tradeoff_results *results = calloc(1, sizeof *results);
    if (!results) {
        report_error(tradeoff->plan.picture, "%s", gscl_result_text(GSCL_ERROR_OUT_OF_MEMORY));
        return EXIT_FAILURE;
    }
    tradeoff->plan.image = image;
    tradeoff->plan.bytes = fixed_bytes(tradeoff, image);
    const int status = run(tradeoff, results);
    for (int i = 0; i < TRADEOFF_BLENDS; i++)
        gscl_free(results->files[i]);
    free(results);
    return status;
}

int command_tradeoff(int argc, char **argv) {
    tradeoff_options tradeoff = {.folder = "tradeoff", .plan.effort = GSCL_DEFAULT_EFFORT};
    int first;
    gscl_image image;
    const option_outcome outcome = parse(&tradeoff, argc, argv, &first);
    if (outcome != OPTIONS_RUN)
        return outcome == OPTIONS_HELP ? EXIT_SUCCESS : EXIT_USAGE;
    if (tradeoff.has_bytes && tradeoff.has_bpp)
        return report_usage("tradeoff", "--bytes and --bpp exclude each other; give one of them");
    tradeoff.plan.picture = argv[first];
    if (!image_read(tradeoff.plan.picture, &image))
        return EXIT_FAILURE;
    const int status = run_on(&tradeoff, &image);
    free(image.pixels);
    return status;
}
