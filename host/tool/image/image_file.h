/* Image files by name: PNG directly, everything else through the image module. */
#ifndef GSCL_TOOL_IMAGE_FILE_H
#define GSCL_TOOL_IMAGE_FILE_H

#include <stdbool.h>

#include <gscl/gscl.h>

#include "cli/output_file.h"

/* Reads an image file, or standard input ("-").  Colours are straight, samples U8, U16 or F32, on the sRGB curve
 * (formats that hold linear light, such as OpenEXR, are converted).  image->pixels is released with free.
 * Reports errors. */
bool image_read(const char *name, gscl_image *image);

/* Writes an image with packed rows and straight colours in the format of the output's suffix, and finishes the
 * output.  Reports errors; the output is closed in any case. */
bool image_write(output_file *output, const gscl_image *image);

#endif
