/* Names of the files that 'gscl encode' writes. */
#ifndef GSCL_TOOL_OUTPUT_NAMES_H
#define GSCL_TOOL_OUTPUT_NAMES_H

#include <stdbool.h>

typedef struct output_naming {
    const char *output;  /* for a single input; NULL: made from the name of the input */
    const char *out_dir; /* NULL: beside the input */
    bool keep_tree;      /* in out_dir, with the folders of the input's name; else without */
    const char *suffix;  /* ".gscl" */
} output_naming;

/* The name of the output of an input, to be released with free.  With keep_tree it lies in out_dir whatever the input:
 * a leading slash and folders "." are left out, and a folder ".." is refused.  NULL with the reason in *problem. */
char *output_name_make(const output_naming *naming, const char *input, const char **problem);

/* The names of all inputs of a command line, none of which would overwrite an input or another output; several may be
 * standard output ("-").  NULL after reporting an error; *status is then the exit code of the program. */
char **output_names_make(const output_naming *naming, char *const *inputs, int count, int *status);

void output_names_free(char **names, int count);

#endif
