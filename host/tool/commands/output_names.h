/* Names of the files that 'gscl encode' writes. */
#ifndef GSCL_TOOL_OUTPUT_NAMES_H
#define GSCL_TOOL_OUTPUT_NAMES_H

#include <stdbool.h>

/* One name per input: `output` if there is one, else the name of the input with this suffix, in `out_dir` if there is
 * one.  NULL when out of memory. */
char **output_names_make(char *const *inputs, int count, const char *output, const char *out_dir, const char *suffix);

/* Whether no output would overwrite an input or another output; otherwise reports a usage error.  Several may be standard
 * output ("-"). */
bool output_names_check(char *const *inputs, char *const *names, int count);

void output_names_free(char **names, int count);

#endif
