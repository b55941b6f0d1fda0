/* What the name of an output stands for: an open descriptor, something else that is written in place, or a file. */
#ifndef GSCL_SYSTEM_OUTPUT_TARGET_H
#define GSCL_SYSTEM_OUTPUT_TARGET_H

#include <stdbool.h>

/* The descriptor of this process that `name` stands for, open or not: 1 for "-", N for /dev/fd/N, /proc/self/fd/N, and
 * what leads there, as /dev/stdout does and >(...) of shells.  -1: none. */
int output_descriptor(const char *name);

/* Whether `name` stands for a descriptor, a pipe or a device, which are no files to be replaced. */
bool output_is_in_place(const char *name);

/* Opens what is in place, as a descriptor of its own.  That of a file is at the place where the file's other writers are.
 * Returns -1 with errno. */
int output_open_in_place(const char *name);

/* The file that is to be replaced or made, behind all symbolic links, to be released with free.  NULL with errno when out
 * of memory, or when links lead in a circle. */
char *output_resolve(const char *name);

#endif
