/* Changes of the samples of an image with packed rows, in the place where they are. */
#ifndef GSCL_TOOL_IMAGE_SAMPLES_H
#define GSCL_TOOL_IMAGE_SAMPLES_H

#include <stdbool.h>

#include <gscl/gscl.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Bytes of a sample. */
size_t image_sample_size(gscl_sample sample);

/* Makes a positive of a negative: colours become their distance from white.  Alpha stays. */
void image_invert_colours(gscl_image *image);

/* Whether the alpha of an image of 2 or 4 channels is 0 everywhere. */
bool image_alpha_is_clear(const gscl_image *image);

/* Removes the last channel of an image of 2 or 4. */
void image_drop_alpha(gscl_image *image);

/* Appends an opaque channel to an image of 1 or 3 channels of U8 samples, whose pixels are allocated with malloc.  Returns
 * false without memory. */
bool image_add_alpha(gscl_image *image);

#ifdef __cplusplus
}
#endif

#endif
