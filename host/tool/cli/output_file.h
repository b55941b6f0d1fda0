/* An output that appears complete or not at all: it is written under a temporary name beside the target and renamed when
 * it is finished.  Standard output ("-"), devices and pipes are written directly.  A symbolic link stays: the file that it
 * names is replaced or, where there is none, made. */
#ifndef GSCL_TOOL_OUTPUT_FILE_H
#define GSCL_TOOL_OUTPUT_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

typedef struct output_file {
    const char *label; /* name in messages, as the user gave it */
    char *target;      /* symbolic links resolved; NULL for standard output */
    char *temporary;   /* NULL when written directly */
    FILE *stream;
    int error; /* errno of the first failed write; reported by output_commit */
} output_file;

/* Whether writing `output` leaves `input` intact; otherwise reports a usage error of `command`. */
bool output_is_separate(const char *command, const char *input, const char *output);

/* Opens `name` ("-": standard output), which must stay valid.  Reports errors. */
bool output_open(output_file *output, const char *name);
/* The same for text, which a terminal can show. */
bool output_open_text(output_file *output, const char *name);

/* Appends bytes.  A failure is kept and reported by output_commit. */
bool output_write(output_file *output, const void *bytes, size_t size);

/* Finishes the output.  Either the file is in place, or an error has been reported and no file is left. */
bool output_commit(output_file *output);

/* Removes an unfinished output.  Does nothing after output_commit. */
void output_discard(output_file *output);

/* The suffix of a file name (".png"), or the end of the name if it has none. */
const char *name_suffix(const char *name);

#endif
