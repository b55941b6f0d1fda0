/* What becomes of the colours of an image that was read. */
#ifndef GSCL_TOOL_IMAGE_COLOURS_H
#define GSCL_TOOL_IMAGE_COLOURS_H

#include <stdbool.h>

#include "image/image_content.h"

/* Converts colours to sRGB, or keeps them and leaves in content->metadata what describes them: code points, a profile,
 * or nothing for sRGB.  Prints notes as the options say.  Returns false after reporting an error about `label`. */
bool image_settle_colours(const char *label, const image_read_options *options, image_content *content);

#endif
