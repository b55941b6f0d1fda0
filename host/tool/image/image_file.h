/* Image files by name: PNG, JPEG, and outputs of TIFF and PNM directly, all other formats through the image module. */
#ifndef GSCL_TOOL_IMAGE_FILE_H
#define GSCL_TOOL_IMAGE_FILE_H

#include <stdbool.h>

#include <gscl/gscl.h>

#include "cli/output_file.h"
#include "image/image_content.h"

/* Reads an image file, or standard input ("-"), with the default options.  Colours are straight or multiplied by alpha,
 * on the curve of sRGB (formats with linear light, such as OpenEXR, are converted), with samples of U8, U16 or F32, and
 * the image is upright.  image->pixels is released with free.  Reports errors. */
bool image_read(const char *name, gscl_image *image);

/* The same with options.  *metadata describes the colours if they are not those of sRGB, and has the blocks to keep; it is
 * released with image_metadata_free. */
bool image_read_with(const char *name, const image_read_options *options, gscl_image *image, image_metadata *metadata);

/* Writes an image with packed rows and straight colours in the format of the suffix of the output, and finishes the
 * output.  Reports errors.  The output is closed in any case. */
bool image_write(output_file *output, const gscl_image *image);

/* The same with metadata that image_prepare_output has prepared. */
bool image_write_with(output_file *output, const gscl_image *image, const image_metadata *metadata);

#endif
