/* Splats of an image that is drawn at another size. */
#ifndef GSCL_LIB_RESIZE_H
#define GSCL_LIB_RESIZE_H

#include <stddef.h>

#include "runtime/real.h"

/* Scales the plane by (sx, sy).  Along an axis that becomes smaller, splats are widened by the variance of a box filter
 * of the size of a new pixel, ((1/s)^2 - 1) / 12 in old pixels, so that small splats do not alias.  Their
 * opacities shrink as their areas grow, also those of splats without one, and their waves become weaker (FORMAT.md,
 * "Rendering"). */
void gscl_resize_splats(float *params, size_t count, gscl_real sx, gscl_real sy);

#endif
