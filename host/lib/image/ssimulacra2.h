/* SSIMULACRA 2.1 (https://github.com/cloudinary/ssimulacra2): how different two images look. */
#ifndef GSCL_LIB_SSIMULACRA2_H
#define GSCL_LIB_SSIMULACRA2_H

#include <gscl/gscl.h>

#define GSCL_SSIMULACRA2_SCALES 6
#define GSCL_SSIMULACRA2_MIN_SIDE 8 /* pixels; a scale whose predecessor is smaller does not count */

/* The weighted sum of the errors of all scales: 0 for equal images, larger is worse.  It is the score before the mapping to
 * its usual range, in double precision.  NaN for images with a side below GSCL_SSIMULACRA2_MIN_SIDE.
 * `a` is the original and `b` the changed image; exchanging them changes the sum.  Both are planes as of
 * gscl_image_to_planes at level 0: 1 (grey) or 3 colours in 0..1, taken as sRGB and premultiplied, then alpha where
 * `channels` is 2 or 4.  With alpha it is the larger sum of two backgrounds, a dark and a bright one.
 * Errors: GSCL_ERROR_OUT_OF_MEMORY. */
gscl_result gscl_ssimulacra2_sum(const float *a, const float *b, uint32_t width, uint32_t height, uint32_t channels,
                                 double *sum);

/* The score of a sum: 100 for 0, falling without limit.  NaN for NaN. */
double gscl_ssimulacra2_score(double sum);

#endif
