/* Image files by name: PNG directly, all other formats through the image module. */
#ifndef GSCL_TOOL_IMAGE_FILE_H
#define GSCL_TOOL_IMAGE_FILE_H

#include <stdbool.h>

#include <gscl/gscl.h>

#include "cli/output_file.h"

/* Reads an image file, or standard input ("-").  Colours are straight, on the sRGB curve (formats with linear light, such
 * as OpenEXR, are converted), with samples of U8, U16 or F32.  image->pixels is released with free.  Reports errors. */
bool image_read(const char *name, gscl_image *image);

/* Writes an image with packed rows and straight colours in the format of the suffix of the output, and finishes the
 * output.  Reports errors.  The output is closed in any case. */
bool image_write(output_file *output, const gscl_image *image);

#endif
