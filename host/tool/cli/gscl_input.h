/* Gscl files as inputs of a command: their form and how they are read. */
#ifndef GSCL_TOOL_GSCL_INPUT_H
#define GSCL_TOOL_GSCL_INPUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <gscl/gscl.h>

#include "cli/options.h"

typedef struct gscl_form {
    bool bare;   /* as in gscl_read_settings */
    bool base64; /* the file is text */
} gscl_form;

#define GSCL_FORM_OPTIONS(form)                                                     \
    {.name = "bare",                                                                \
     .kind = OPTION_FLAG,                                                           \
     .value = &(form).bare,                                                         \
     .help = "the input was made by 'gscl encode --bare'"},                         \
    {                                                                               \
        .name = "base64", .kind = OPTION_FLAG, .value = &(form).base64,             \
        .help = "the input is text: base64url of 'gscl encode --base64', or base64" \
    }

/* Limits on what a file may ask of this machine (gscl_decode_settings). */
typedef struct gscl_limits {
    uint64_t max_pixels, max_work;
} gscl_limits;

/* 100 megapixels, 400 MB of RGBA; minutes of one core, and a thousand times what a photograph of 24 megapixels needs. */
#define GSCL_DEFAULT_LIMITS \
    { 100000000, 100000000000 }

#define GSCL_LIMIT_OPTIONS(limits)                                                                                  \
    {.name = "max-pixels",                                                                                          \
     .kind = OPTION_INTEGER,                                                                                        \
     .value = &(limits).max_pixels,                                                                                 \
     .argument = "N",                                                                                               \
     .min_integer = 1,                                                                                              \
     .max_integer = UINT64_MAX,                                                                                     \
     .help = "refuse to draw more pixels (default 100000000)"},                                                     \
    {                                                                                                               \
        .name = "max-work", .kind = OPTION_INTEGER, .value = &(limits).max_work, .argument = "N", .min_integer = 1, \
        .max_integer = UINT64_MAX,                                                                                  \
        .help = "refuse a file that needs more evaluations of a splat at a pixel, see 'gscl info' (default "        \
                "100000000000)"                                                                                     \
    }

/* Reads the gscl file `name` ("-": standard input) into *bytes, to be released with free.  A packet becomes a list of one;
 * packets of a list or of lines of text that are of no use are left out with a warning.  Reports errors. */
bool read_gscl_file(const char *name, const gscl_form *form, uint8_t **bytes, size_t *size);

/* The same for several files, which then all hold packets, of one picture. */
bool read_gscl_files(char *const *names, int count, const gscl_form *form, uint8_t **bytes, size_t *size);

/* Whether drawing the picture of a file stays within the limits.  Reports an error about `name` otherwise. */
bool is_within_limits(const char *name, const gscl_info *info, const gscl_limits *limits);

/* The settings of the library for this form. */
gscl_read_settings read_settings_of(const gscl_form *form);

#endif
