/* The image formats that gscl writes, and what each can hold. */
#ifndef GSCL_TOOL_IMAGE_FORMAT_H
#define GSCL_TOOL_IMAGE_FORMAT_H

#include <stdbool.h>

#include <gscl/gscl.h>

typedef struct image_format {
    const char *suffix;
    bool grey, colour, alpha;
    int bits; /* most bits a sample; 32 is floating point */
} image_format;

/* The format that a file name's suffix names ("-", standard output, is PNG).  Unknown: reports a usage error
 * of `command` and returns NULL. */
const image_format *image_format_of(const char *command, const char *name);

/* Whether the format holds such an image; else reports an error about `name`. */
bool image_format_holds(const image_format *format, const char *name, unsigned channels, gscl_sample sample);

#endif
