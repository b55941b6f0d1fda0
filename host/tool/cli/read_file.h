/* Reading a whole file, or standard input, into memory. */
#ifndef GSCL_TOOL_READ_FILE_H
#define GSCL_TOOL_READ_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Limits on the size of inputs, so that an endless input does not fill the memory. */
#define MAX_GSCL_FILE ((uint64_t)256 << 20)   /* bytes; the largest possible gscl file is far smaller */
#define MAX_IMAGE_FILE ((uint64_t)2560 << 20) /* bytes; 16384 x 16384 x RGBA x 16 bit is 2048 MiB */

/* The name of an input in messages: "-" is standard input. */
const char *input_label(const char *name);

/* Reads `name` ("-": standard input) into *bytes, to be released with free.  Reports errors. */
bool read_file(const char *name, uint64_t limit, uint8_t **bytes, size_t *size);

/* Reads up to `capacity` bytes from the start of a file, not of standard input; *count may be less.  Reports errors. */
bool read_file_start(const char *name, uint8_t *bytes, size_t capacity, size_t *count);

#endif
