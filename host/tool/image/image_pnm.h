/* Writes PNM: binary PGM for grey, PPM for RGB.  The image module reads PNM, but does not write 16-bit samples. */
#ifndef GSCL_TOOL_IMAGE_PNM_H
#define GSCL_TOOL_IMAGE_PNM_H

#include <stdbool.h>

#include <gscl/gscl.h>

#include "cli/output_file.h"

/* Whether the suffix of a file name is one of PNM. */
bool image_is_pnm_name(const char *name);

/* Writes an image of 1 or 3 channels, U8 or U16 samples, packed rows.  On failure returns false and sets
 * output->error. */
bool image_write_pnm(output_file *output, const gscl_image *image);

#endif
