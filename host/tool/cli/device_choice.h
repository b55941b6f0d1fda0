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
    bool verbose;       /* the library's messages on stderr */
    bool timing;        /* as in gscl_context_settings */
    bool quiet;         /* no note while kernels are built */
    bool no_cache;      /* neither read nor keep built kernels */
} device_choice;

#define DEVICE_HELP "device: its number P.D, part of its name, or host (default: see 'gscl devices')"
#define DEVICE_OPTIONS(choice) DEVICE_OPTIONS_AS(choice, DEVICE_HELP)
#define DEVICE_OPTIONS_AS(choice, device_help)                                                                         \
    {.name = "device", .kind = OPTION_TEXT, .value = &(choice).device, .argument = "D", .help = device_help},          \
        {.name = "no-cache",                                                                                           \
         .kind = OPTION_FLAG,                                                                                          \
         .value = &(choice).no_cache,                                                                                  \
         .help =                                                                                                       \
             "build kernels anew and do not keep them (default: kept in $XDG_CACHE_HOME/gscl or ~/.cache/gscl, where " \
             "OpenCL does not keep them itself, as PoCL does)"},                                                       \
    {                                                                                                                  \
        .name = "mapping", .kind = OPTION_WORD, .value = &(choice).mapping, .words = mapping_words, .argument = "M",   \
        .help = "kernels for a CPU or for a GPU (default: auto, by the device)"                                        \
    }

/* Opens the device as gscl_context_create does: on failure *context has the message, or is NULL. */
gscl_result create_context(const device_choice *choice, gscl_context **context);

/* Opens the device; reports errors.  Returns the program's exit code; *context is NULL unless that is 0. */
int open_device(const device_choice *choice, gscl_context **context);

/* The same for decoding to `pixels` pixels.  Without a choice it opens the device "host" where that is the faster one
 * (DECODER_CHOICE_HELP), or where there is no OpenCL device. */
int open_decoder(const device_choice *choice, uint64_t pixels, gscl_context **context);

/* The rule of open_decoder, in megapixels: for pictures up to the first limit "host" ends before an OpenCL device has
 * started and drawn; up to the second, before kernels have been built.  Measured as whole processes on two cores with AVX2
 * and PoCL 3: for 0.4, 1.6, 3.5 and 14 megapixels "host" takes 0.03, 0.06, 0.11 and 0.54 s, and PoCL 0.09, 0.11, 0.18 and
 * 0.40 s; building the kernels takes PoCL 2.1 s more. */
#define HOST_MEGAPIXELS 3
#define HOST_MEGAPIXELS_UNBUILT 16
#define DECODER_CHOICE_HELP                                                                                           \
    "Without --device and --mapping, pictures up to 3 megapixels, and up to 16 while PoCL has no folder of built\n"   \
    "kernels, are drawn by the device 'host', which needs no OpenCL and is then the faster one; larger ones by the\n" \
    "default of 'gscl devices'; all where there is no OpenCL device by 'host'."

/* Writes what failed in a call of the library, with advice (`context` may be NULL). */
#define EXPLANATION_SIZE 2048 /* bytes, the NUL included */
void explain_result(const gscl_context *context, gscl_result result, char text[EXPLANATION_SIZE]);

/* Reports a failed call of the library about `subject` (`context` may be NULL) and returns the program's exit
 * code for it. */
int report_result(const gscl_context *context, const char *subject, gscl_result result);

#endif
