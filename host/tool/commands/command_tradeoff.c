/* gscl tradeoff: accuracy against time, as tables and plots. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gscl/gscl.h>

#include "cli/message.h"
#include "cli/options.h"
#include "cli/rate.h"
#include "commands/command.h"
#include "image/image_file.h"
#include "tradeoff/tradeoff.h"
#include "tradeoff/tradeoff_files.h"
#include "tradeoff/tradeoff_tables.h"

#define DEFAULT_BPP 0.125
#define MIN_DEFAULT_BYTES 256.0
#define MAX_FILE_BYTES UINT32_MAX

typedef struct tradeoff_options {
    tradeoff_plan plan;
    const char *folder;
    uint64_t bytes;
    double bpp;
    bool has_bytes, has_bpp, as_json;
    opencl_device_id device;
} tradeoff_options;

#define PURPOSE "'gscl tradeoff' builds kernels of several precisions, which needs an OpenCL device"
#define DEVICE_HELP_OF_TRADEOFF "OpenCL device: its number P.D or part of its name (default: a GPU, else the first one)"

static option_outcome parse_tradeoff(tradeoff_options *tradeoff, int argc, char **argv, int *first) {
    const option_spec options[] = {
        {.name = "out",
         .letter = 'o',
         .kind = OPTION_TEXT,
         .value = &tradeoff->folder,
         .argument = "DIR",
         .help = "folder for the tables (CSV, JSON) and plots (SVG, PNG), made if it is missing (default tradeoff)"},
        {.name = "bytes",
         .kind = OPTION_INTEGER,
         .value = &tradeoff->bytes,
         .given = &tradeoff->has_bytes,
         .argument = "N",
         .min_integer = 1,
         .max_integer = MAX_FILE_BYTES,
         .help = "file size at which efforts are compared"},
        {.name = "bpp",
         .kind = OPTION_REAL,
         .value = &tradeoff->bpp,
         .given = &tradeoff->has_bpp,
         .argument = "R",
         .min_real = 0.0001,
         .max_real = 8.0,
         .help = "file size in bits per pixel (default 0.125, or 256 bytes if that is more)"},
        {.name = "effort",
         .kind = OPTION_INTEGER,
         .value = &tradeoff->plan.effort,
         .argument = "N",
         .min_integer = 0,
         .max_integer = GSCL_MAX_EFFORT,
         .help = "effort at which rates are compared (default 5)"},
        {.name = "quick",
         .kind = OPTION_FLAG,
         .value = &tradeoff->plan.quick,
         .help = "measure fewer efforts and rates, each once: rough figures in less time"},
        DEVICE_OPTIONS_AS(tradeoff->plan.choice, DEVICE_HELP_OF_TRADEOFF),
        {.name = "json", .kind = OPTION_FLAG, .value = &tradeoff->as_json, .help = "write JSON instead of tables"},
    };
    const option_command command = {
        .name = "tradeoff",
        .usage = "IMAGE [--out DIR] [--bytes N | --bpp R] [--quick] [options]",
        .about =
            "Measures accuracy against time on this machine: quality against encode time at every effort, quality\n"
            "against rate, and the errors of the renderer and of the fit's gradients against double precision.\n"
            "Prints tables, and writes tables and plots into a folder.  Takes one or two minutes, and an OpenCL "
            "device.",
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
                                        : fmax(DEFAULT_BPP * pixels / 8, MIN_DEFAULT_BYTES));
}

/* Fills in the line below the titles of the plots. */
static void write_subtitle(const tradeoff_plan *plan, tradeoff_results *results) {
    const char *slash = strrchr(plan->image_name, '/');
    snprintf(results->subtitle, sizeof results->subtitle,
             "%.60s, %ux%u pixels; %llu bytes (%.3f bits per pixel) and effort %d unless stated otherwise; %.80s",
             slash ? slash + 1 : plan->image_name, plan->image->width, plan->image->height,
             (unsigned long long)plan->bytes, bits_per_pixel(plan->bytes, plan->image->width, plan->image->height),
             (int)plan->effort, results->device.device_name);
}

static int measure_tradeoff(const tradeoff_plan *plan, tradeoff_results *results) {
    const int status = tradeoff_measure_codec(plan, results);
    if (status != EXIT_SUCCESS)
        return status;
    write_subtitle(plan, results);
    return tradeoff_measure_accuracy(plan, results);
}

static int write_tradeoff(const tradeoff_options *tradeoff, tradeoff_results *results) {
    tradeoff_files files;
    if (!tradeoff_files_open(&files, tradeoff->folder))
        return EXIT_FAILURE;
    const int status = measure_tradeoff(&tradeoff->plan, results);
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

static int run_tradeoff(tradeoff_options *tradeoff, const gscl_image *image) {
    tradeoff_results *results = calloc(1, sizeof *results);
    if (!results) {
        report_error(tradeoff->plan.image_name, "%s", gscl_result_text(GSCL_ERROR_OUT_OF_MEMORY));
        return EXIT_FAILURE;
    }
    tradeoff->plan.image = image;
    tradeoff->plan.bytes = fixed_bytes(tradeoff, image);
    const int status = write_tradeoff(tradeoff, results);
    for (int i = 0; i < TRADEOFF_BLENDS; i++)
        gscl_free(results->files[i]);
    free(results);
    return status;
}

int command_tradeoff(int argc, char **argv) {
    tradeoff_options tradeoff = {.folder = "tradeoff", .plan.effort = GSCL_DEFAULT_EFFORT};
    int first;
    gscl_image image;
    const option_outcome outcome = parse_tradeoff(&tradeoff, argc, argv, &first);
    if (outcome != OPTIONS_RUN)
        return options_exit_code(outcome);
    if (tradeoff.has_bytes && tradeoff.has_bpp)
        return report_usage("tradeoff", "--bytes and --bpp exclude each other; give one of them");
    const int chosen = choose_opencl_device("tradeoff", PURPOSE, &tradeoff.plan.choice, tradeoff.device);
    if (chosen != EXIT_SUCCESS)
        return chosen;
    tradeoff.plan.image_name = argv[first];
    if (!image_read(tradeoff.plan.image_name, &image))
        return EXIT_FAILURE;
    const int status = run_tradeoff(&tradeoff, &image);
    free(image.pixels);
    return status;
}
