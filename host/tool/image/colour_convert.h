/* Conversion of pixels between colour profiles. */
#ifndef GSCL_TOOL_COLOUR_CONVERT_H
#define GSCL_TOOL_COLOUR_CONVERT_H

#include <stdbool.h>

#include "image/colour_profile.h"

/* Converts the pixels of an image with packed rows to sRGB, at the precision of its samples.  Colours become straight,
 * inks become RGB; alpha stays.  Uses relative colorimetric intent with black point compensation.  Returns false without
 * memory or if the profile allows no conversion; the image is then as it was. */
bool colour_convert_to_srgb(const colour_profile *profile, gscl_image *image);

#endif
