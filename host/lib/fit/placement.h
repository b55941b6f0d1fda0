/* Placement of splats on a level of the pyramid by a density: where, how large and in which direction. */
#ifndef GSCL_LIB_PLACEMENT_H
#define GSCL_LIB_PLACEMENT_H

#include "fit/fit.h"

/* Maps of the current level while splats are placed. */
typedef struct gscl_placement {
    int width, height, channels;
    bool rotated;        /* splats have an angle */
    float scale;         /* full-size pixels per pixel of the level */
    size_t count;        /* of splats that are placed */
    int strip;           /* height of a strip, pixels of the level */
    float *density;      /* of new splats, per pixel, not normalised */
    double *sums;        /* cumulative density at the end of each column of each strip, in the order of the walk */
    double *scratch;     /* as many as the longer side has */
    const float *target; /* channels planes of `rows` rows, from row `top` on (gscl_placement_read_target) */
    int top, rows;
    float *band; /* the target's memory, of a large level; NULL: it is the fit's */
} gscl_placement;

/* Makes the maps for `count` splats, and room for all rows of the target or, where not `all`, as many as one strip needs
 * and target_band_pixels allow.  gscl_placement_free also after a failure; a zeroed structure is fine. */
gscl_result gscl_placement_create(gscl_placement *placement, gscl_fit *fit, size_t count, bool all);
void gscl_placement_free(gscl_placement *placement);

/* Reads the target for splats in the strip of row `y`, unless its rows have been read. */
gscl_result gscl_placement_read_target(gscl_placement *placement, gscl_fit *fit, int y);

/* Number of pixels of the level outside the flat background, which need splats. */
float gscl_placement_area(const gscl_placement *placement, const gscl_fit *fit);

/* Prepares systematic sampling of the pixels by the density: the image is cut into strips about as high as the mean
 * distance of the new splats, which are walked to and fro, column by column, and every count-th part of the density on
 * this way gets one splat.  Splats thus keep apart from each other, which independent samples do not. */
void gscl_placement_accumulate(gscl_placement *placement);
/* Pixel of sample `index` (below count): random within its part of the density.  Samples follow the walk, so that the
 * strips of their pixels come from top to bottom. */
size_t gscl_placement_sample(const gscl_placement *placement, size_t index, uint64_t *random);
/* Distance between samples where the density is that of the pixel: pixels of the level. */
float gscl_placement_distance(const gscl_placement *placement, size_t pixel);

/* Makes a splat at a random point of the pixel, with the pixel's colour.  `sigma`: full-size pixels.  Where splats have
 * an angle it lies along the edge at the pixel, if there is one, and is elongated.  The target has been
 * read. */
void gscl_placement_splat(const gscl_placement *placement, size_t pixel, float sigma, float opacity, uint64_t *random,
                          float *params);

#endif
