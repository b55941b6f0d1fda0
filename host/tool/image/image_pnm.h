/* Writing PNM: binary PGM for grey, PPM for RGB.  (Reading is left to the image module, whose writer knows no
 * 16-bit samples.) */
#ifndef GSCL_TOOL_IMAGE_PNM_H
#define GSCL_TOOL_IMAGE_PNM_H

#include <stdbool.h>

#include <gscl/gscl.h>

#include "cli/output_file.h"

/* Whether a file name's suffix is one of PNM's. */
bool image_is_pnm_name(const char *name);

/* Writes an image of 1 or 3 channels, U8 or U16 samples, packed rows.  False with output->error set when the output
 * failed. */
bool image_write_pnm(output_file *output, const gscl_image *image);

#endif
