/* The source image on the device at sizes that halve from level to level.  Level 0 has full size. */
#ifndef GSCL_LIB_FIT_PYRAMID_H
#define GSCL_LIB_FIT_PYRAMID_H

#include "runtime/launch.h"

#define GSCL_MAX_LEVELS 15 /* 16384 pixels down to 1 */

typedef struct gscl_pyramid {
    gscl_context *context;
    uint32_t width, height;      /* of the full-size image */
    int first_level, last_level; /* levels that exist, from the largest to the smallest image */
    int channels;
    int weighted;                        /* GSCL_WEIGHTED_... */
    gscl_buffer levels[GSCL_MAX_LEVELS]; /* planes of each level, then those of its weights */
} gscl_pyramid;

/* Builds the levels of `planes`, which are an image of the size of `first_level`, down to a shorter side of about
 * gscl_fit_tunables.min_level_side.  `weighted`: GSCL_WEIGHTED_...; each level has room for its planes, which are zeros
 * with GSCL_WEIGHTED_LUMA, and are built by gscl_weights_build with GSCL_WEIGHTED_PIXELS.
 * `pyramid` must be zeroed. */
gscl_result gscl_pyramid_create(gscl_pyramid *pyramid, gscl_context *context, uint32_t width, uint32_t height,
                                int first_level, int channels, int weighted, const float *planes);
/* Releases the levels smaller than this one, unless they have weights that were built. */
void gscl_pyramid_release_smaller(gscl_pyramid *pyramid, int level);
/* Makes a level again if it was released, and those between it and the larger ones that are left, with weights of zero
 * where they have any. */
gscl_result gscl_pyramid_restore(gscl_pyramid *pyramid, int level);
/* Accepts a zeroed pyramid. */
void gscl_pyramid_free(gscl_pyramid *pyramid);

/* Size of a level in pixels. */
uint32_t gscl_pyramid_width(const gscl_pyramid *pyramid, int level);
uint32_t gscl_pyramid_height(const gscl_pyramid *pyramid, int level);
size_t gscl_pyramid_pixels(const gscl_pyramid *pyramid, int level);

/* Halves plane `channel` of an image of this level's size into the same plane of an image of the next level's size. */
gscl_result gscl_pyramid_halve(const gscl_pyramid *pyramid, int level, size_t channel, const gscl_buffer *from,
                               const gscl_buffer *to);

/* A kernel of cl/image.cl, whose program does not depend on the image. */
gscl_result gscl_image_kernel(gscl_context *context, const char *name, gscl_kernel **kernel);

#endif
