/* A synthetic image for benchmarks: overlapping discs of all sizes (the dead leaves model), whose edges and smooth areas
 * have the statistics of photographs. */
#ifndef GSCL_TOOL_SYNTHETIC_IMAGE_H
#define GSCL_TOOL_SYNTHETIC_IMAGE_H

#include <stdbool.h>

#include <gscl/gscl.h>

/* Makes an RGB image of 8 bits, the same for the same size.  image->pixels is released with free.  Returns false when out
 * of memory. */
bool synthetic_image_make(gscl_image *image, uint32_t width, uint32_t height);

#endif
