/* Splats of a picture that is drawn at another size. */
#ifndef GSCL_LIB_RESIZE_H
#define GSCL_LIB_RESIZE_H

#include <stddef.h>

/* Scales the plane by (sx, sy).  Where that makes the picture smaller, splats are widened by the variance
 * of the box filter that a pixel then is, ((1/s)^2 - 1) / 12 of the unscaled plane, so that small splats
 * do not alias. */
void gscl_resize_splats(float *params, size_t count, double sx, double sy);

#endif
