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

#define GSCL_FORM_OPTIONS(form)                                         \
    {.name = "bare",                                                    \
     .kind = OPTION_FLAG,                                               \
     .value = &(form).bare,                                             \
     .help = "the input was made by 'gscl encode --bare'"},             \
    {                                                                   \
        .name = "base64", .kind = OPTION_FLAG, .value = &(form).base64, \
        .help = "the input was made by 'gscl encode --base64'"          \
    }

/* Reads the gscl file `name` ("-": standard input) into *bytes, to be released with free.  Reports errors. */
bool read_gscl_file(const char *name, const gscl_form *form, uint8_t **bytes, size_t *size);

/* The settings of the library for this form. */
gscl_read_settings read_settings_of(const gscl_form *form);

#endif
