/* What of the colours and the metadata of a gscl file an output image can hold. */
#ifndef GSCL_TOOL_IMAGE_OUTPUT_H
#define GSCL_TOOL_IMAGE_OUTPUT_H

#include <stdbool.h>

#include "image/image_content.h"
#include "image/image_format.h"

/* Prepares an image with packed rows, straight colours and metadata for image_write_with: where the format holds no
 * profile, and where the image will be drawn over a background of sRGB, colours are converted to sRGB; blocks that it cannot hold are emptied.  Prints what it did as notes about
 * `label`, the kept blocks only when `verbose`.  Returns false after reporting an error. */
bool image_prepare_output(const char *label, const image_format *format, bool on_background, bool verbose,
                          gscl_image *image, image_metadata *metadata);

#endif
