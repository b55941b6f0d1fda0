/* The OpenCL device of a command: its options, opening it, and reporting the library's errors. */
#ifndef GSCL_TOOL_DEVICE_CHOICE_H
#define GSCL_TOOL_DEVICE_CHOICE_H

#include <stdbool.h>

#include <gscl/gscl.h>

#include "cli/names.h"
#include "cli/options.h"

typedef struct device_choice {
    const char *device; /* NULL: the library's choice */
    int mapping;        /* index into mapping_words, which is a gscl_mapping */
    bool verbose;       /* the library's messages on stderr */
    bool timing;        /* as in gscl_context_settings */
} device_choice;

#define DEVICE_OPTIONS(choice)                                                                                       \
    {.name = "device",                                                                                               \
     .kind = OPTION_TEXT,                                                                                            \
     .value = &(choice).device,                                                                                      \
     .argument = "D",                                                                                                \
     .help = "OpenCL device: its number P.D or part of its name (default: see 'gscl devices')"},                     \
    {                                                                                                                \
        .name = "mapping", .kind = OPTION_WORD, .value = &(choice).mapping, .words = mapping_words, .argument = "M", \
        .help = "kernels for a CPU or for a GPU (default: auto, by the device)"                                      \
    }

/* Opens the device; reports errors.  Returns the program's exit code; *context is NULL unless that is 0. */
int open_device(const device_choice *choice, gscl_context **context);

/* Reports a failed call of the library about `subject` (`context` may be NULL) and returns the program's exit
 * code for it. */
int report_result(const gscl_context *context, const char *subject, gscl_result result);

#endif
