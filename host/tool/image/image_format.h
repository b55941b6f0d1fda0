/* The image formats that gscl writes, and the images that each can hold. */
#ifndef GSCL_TOOL_IMAGE_FORMAT_H
#define GSCL_TOOL_IMAGE_FORMAT_H

#include <stdbool.h>

#include <gscl/gscl.h>

typedef struct image_format {
    const char *suffix;
    bool grey, colour, alpha;
    bool metadata; /* a colour profile, EXIF and XMP */
    int bits;      /* maximum bits per sample; 32 is floating point */
} image_format;

/* What pipes and devices without a suffix take, "-" and /dev/stdout among them. */
#define IMAGE_PIPE_SUFFIX ".png"

/* Whether the suffix of a file name is that of a format. */
bool image_format_has_suffix(const char *name);

/* The format of the suffix of a file name, or of IMAGE_PIPE_SUFFIX.  NULL after reporting a usage error of `command`
 * for an unknown suffix. */
const image_format *image_format_of(const char *command, const char *name);

/* Whether the format can hold such an image, but for alpha (image_alpha.h); otherwise reports an error about `name`. */
bool image_format_holds(const image_format *format, const char *name, unsigned channels, gscl_sample sample);

#endif
