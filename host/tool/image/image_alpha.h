/* Images without their alpha. */
#ifndef GSCL_TOOL_IMAGE_ALPHA_H
#define GSCL_TOOL_IMAGE_ALPHA_H

#include <stdbool.h>

#include <gscl/gscl.h>

#include "cli/options.h"
#include "image/image_format.h"

/* The channels in which an image of `channels` is written in a format: alpha goes where the format holds none, and over a
 * background, which may be NULL; grey over a background of another colour becomes RGB. */
unsigned image_written_channels(unsigned channels, const image_format *format, const option_colour *background);

/* Makes an image without alpha of one with packed rows and straight colours: drawn over the background, on the curve of
 * sRGB as browsers do, or with alpha left out where it is 1 everywhere.  flat->pixels is released with free; it is NULL where
 * the image is written as it is.  Returns false after reporting an error about `label`, the output. */
bool image_flatten(const char *label, const image_format *format, const option_colour *background,
                   const gscl_image *image, gscl_image *flat);

#endif
