/* A made-up picture to measure on when there is none: leaves of all sizes, one over the other, with the statistics of
 * edges and smooth places that photographs have. */
#ifndef GSCL_TOOL_TEST_PICTURE_H
#define GSCL_TOOL_TEST_PICTURE_H

#include <stdbool.h>

#include <gscl/gscl.h>

/* Makes an RGB picture of 8 bits, always the same.  image->pixels is released with free.  False: out of memory. */
bool synthetic_image_make(gscl_image *image, uint32_t width, uint32_t height);

#endif
