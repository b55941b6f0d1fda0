/* Turning an image upright. */
#ifndef GSCL_TOOL_ORIENTATION_H
#define GSCL_TOOL_ORIENTATION_H

#include <stdbool.h>

#include <gscl/gscl.h>

/* Turns an image with packed rows whose pixels lie as `orientation`, 1 to 8 as EXIF counts, says.  Its pixels, allocated
 * with malloc, are replaced.  Returns false without memory. */
bool orientation_apply(gscl_image *image, int orientation);

#endif
