/* An output that appears complete or not at all: it is written under a temporary name beside the target and renamed when
 * it is finished.  The temporary name follows from that of the target, so that what a killed process leaves is used again
 * by the next one that writes the target.  What output_target.h says to be written in place is: descriptors, pipes and
 * devices.  A symbolic link stays: the file that it names is replaced or, where there is none, made. */
#ifndef GSCL_TOOL_OUTPUT_FILE_H
#define GSCL_TOOL_OUTPUT_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef struct output_file {
    const char *label; /* name in messages, as the user gave it */
    char *target;      /* symbolic links resolved; NULL when written in place */
    char *temporary;   /* likewise */
    FILE *stream;
    int lock;  /* keeps the lock of the temporary file until it is renamed; 0: none */
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

/* Waits until what was written is stored, so that a loss of power after output_commit leaves the new file or the old one.
 * Likewise. */
bool output_store(output_file *output);

/* Finishes the output.  Either the file is in place, or an error has been reported and no file is left. */
bool output_commit(output_file *output);

/* Removes an unfinished output.  Does nothing after output_commit. */
void output_discard(output_file *output);

/* Whether `name` is a file that is not empty.  *size is that of the file. */
bool output_exists(const char *name, uint64_t *size);

/* Removes what a killed process left of an output, unless another process is writing it. */
void output_remove_leftover(const char *name);

/* Makes the folders of a name that do not exist.  Reports errors. */
bool output_make_folders(const char *name);

/* The suffix of a file name (".png"), or the end of the name if it has none. */
const char *name_suffix(const char *name);

/* Takes the last of *count operands as the output, which must not exist, so that a pattern of the shell replaces nothing.
 * Returns 0, or EXIT_USAGE after reporting that it exists. */
int output_take_operand(const char *command, char *const *operands, int *count, const char **output);

#endif
