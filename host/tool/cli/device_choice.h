/* The device of a command: its options, opening it, and reporting the library's errors. */
#ifndef GSCL_TOOL_DEVICE_CHOICE_H
#define GSCL_TOOL_DEVICE_CHOICE_H

#include <stdbool.h>
#include <stdint.h>

#include <gscl/gscl.h>

#include "cli/names.h"
#include "cli/options.h"

typedef struct device_choice {
    const char *device; /* NULL: the library's choice */
    int mapping;        /* index into mapping_words, which is a gscl_mapping */
    uint64_t threads;   /* of the device "host"; 0: as many as the process may run */
    bool verbose;       /* the library's messages on stderr */
    bool timing;        /* as in gscl_context_settings */
    bool quiet;         /* no note while kernels are built */
    bool no_cache;      /* neither read nor keep built kernels */
} device_choice;

#define DEVICE_HELP "device: its number P.D, part of its name, or host (default: see 'gscl devices')"
#define DEVICE_OPTIONS(choice) DEVICE_OPTIONS_AS(choice, DEVICE_HELP)
#define DEVICE_OPTIONS_AS(choice, device_help)                                                                       \
    {.name = "device", .kind = OPTION_TEXT, .value = &(choice).device, .argument = "D", .help = device_help},        \
        {.name = "threads",                                                                                          \
         .kind = OPTION_INTEGER,                                                                                     \
         .value = &(choice).threads,                                                                                 \
         .argument = "N",                                                                                            \
         .min_integer = 1,                                                                                           \
         .max_integer = GSCL_MAX_THREADS,                                                                            \
         .help = "threads of the device host; the result does not depend on them (default: as many as the process "  \
                 "may run)"},                                                                                        \
        {.name = "no-cache",                                                                                         \
         .kind = OPTION_FLAG,                                                                                        \
         .value = &(choice).no_cache,                                                                                \
         .help = "build the kernels of an OpenCL device anew and do not keep them (default: kept in "                \
                 "$XDG_CACHE_HOME/gscl or ~/.cache/gscl, where OpenCL does not keep them itself, as PoCL does)"},    \
    {                                                                                                                \
        .name = "mapping", .kind = OPTION_WORD, .value = &(choice).mapping, .words = mapping_words, .argument = "M", \
        .help = "kernels for a CPU or for a GPU (default: auto, by the device)"                                      \
    }

/* Opens the device as gscl_context_create does: on failure *context has the message, or is NULL. */
gscl_result create_context(const device_choice *choice, gscl_context **context);

/* Opens the device; reports errors.  Returns the program's exit code; *context is NULL unless that is 0. */
int open_device(const device_choice *choice, gscl_context **context);

/* The same for decoding to `pixels` pixels.  Without a choice it opens the device that DECODER_CHOICE_HELP says. */
int open_decoder(const device_choice *choice, uint64_t pixels, gscl_context **context);

/* The rule of open_decoder, in megapixels: pictures up to the first limit are drawn by "host" before an OpenCL device has
 * started and drawn them.  The second limit is for a "host" that has no kernels for this processor and draws on one core: up
 * to it, "host" ends before an OpenCL device has built its kernels.  Measured as whole processes on two cores with AVX2 and
 * PoCL 3: for 0.4, 1.6, 3.5 and 14 megapixels one core takes 0.03, 0.06, 0.11 and 0.54 s, and PoCL 0.09, 0.11, 0.18 and
 * 0.40 s; building the kernels takes PoCL 2.1 s more. */
#define HOST_MEGAPIXELS 3
#define HOST_MEGAPIXELS_UNBUILT 16
#define DECODER_CHOICE_HELP                                                                                            \
    "Without --device and --mapping, pictures up to 3 megapixels are drawn by the device 'host', before a GPU has\n"   \
    "started; larger ones by the default of 'gscl devices'.  Where this program has no kernels for the processor,\n"   \
    "'host' draws on one core: then pictures up to 16 megapixels while PoCL has no folder of built kernels, and all\n" \
    "where there is no OpenCL device."

/* For a command that the device "host" cannot run: without a choice it chooses an OpenCL device, whose id it stores in `id`.
 * `purpose` says for what, "'gscl x' needs y".  Reports errors and returns the program's exit code. */
typedef char opencl_device_id[sizeof((gscl_device_info *)0)->id];
int choose_opencl_device(const char *command, const char *purpose, device_choice *choice, opencl_device_id id);

/* Writes what failed in a call of the library, with advice (`context` may be NULL). */
#define EXPLANATION_SIZE 2048 /* bytes, the NUL included */
void explain_result(const gscl_context *context, gscl_result result, char text[EXPLANATION_SIZE]);

/* Reports a failed call of the library about `subject` (`context` may be NULL) and returns the program's exit
 * code for it. */
int report_result(const gscl_context *context, const char *subject, gscl_result result);

#endif
