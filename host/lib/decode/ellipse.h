/* The size of a splat on the host; cl/project.cl computes the same in single precision. */
#ifndef GSCL_LIB_ELLIPSE_H
#define GSCL_LIB_ELLIPSE_H

#include "runtime/elementary.h"

typedef struct gscl_half_size {
    gscl_real width, height;
} gscl_half_size;

/* Half width and half height of the ellipse at `reach` standard deviations of a Gaussian with the axes exp(log_s1) and
 * exp(log_s2), the first of them in the direction `theta`, after adding `variance` (square pixels) in all directions.
 * The outline of a splat has the reach sqrt(2 * GSCL_SUPPORT). */
static inline gscl_half_size gscl_ellipse_half_size(gscl_real log_s1, gscl_real log_s2, gscl_real theta,
                                                    gscl_real variance, gscl_real reach) {
    const gscl_real c = gscl_cos(theta), s = gscl_sin(theta), v1 = gscl_exp(2 * log_s1), v2 = gscl_exp(2 * log_s2);
    return (gscl_half_size){reach * gscl_real_sqrt(c * c * v1 + s * s * v2 + variance),
                            reach * gscl_real_sqrt(s * s * v1 + c * c * v2 + variance)};
}

#endif
