/* An output that appears complete or not at all: written under a temporary name beside the target and renamed
 * when finished.  Standard output ("-"), devices and pipes are written directly. */
#ifndef GSCL_TOOL_OUTPUT_FILE_H
#define GSCL_TOOL_OUTPUT_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

typedef struct output_file {
    const char *label; /* the user's name for it, in messages */
    char *target;      /* symbolic links resolved; NULL for standard output */
    char *temporary;   /* NULL when written directly */
    FILE *stream;
    int error; /* errno of the first failed write; reported by output_commit */
} output_file;

/* Reports a usage error of `command` when writing `output` would destroy `input`. */
bool output_is_separate(const char *command, const char *input, const char *output);

/* Opens `name` ("-": standard output), which must stay valid.  Reports errors. */
bool output_open(output_file *output, const char *name);

/* Appends bytes.  A failure is kept and reported by output_commit. */
bool output_write(output_file *output, const void *bytes, size_t size);

/* Finishes: the file is in place, or an error has been reported and nothing is left. */
bool output_commit(output_file *output);

/* Gives up: nothing is left.  Does nothing after output_commit. */
void output_discard(output_file *output);

/* Where a file name's suffix (".png") starts, or the end of the name if it has none. */
const char *name_suffix(const char *name);

#endif
