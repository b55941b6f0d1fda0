/* FORMAT.md's "Rendering" in double precision on the host: the reference for the accuracy of the kernels. */
#ifndef GSCL_LIB_REFERENCE_H
#define GSCL_LIB_REFERENCE_H

#include "runtime/launch.h"

#define GSCL_REFERENCE_NO_CUT 40.0 /* as `support`: Gaussians below exp(-40) do not change a sum in double precision */

/* A projected splat. */
typedef struct gscl_reference_splat {
    double x, y;
    double ux, uy, vx, vy;          /* q = (ux dx + uy dy)^2 + (vx dx + vy dy)^2 */
    double half_width, half_height; /* of the outline q = support, pixels */
    double opacity, colour[4];
    double wave_x, wave_y, phase, amplitude; /* cycles per pixel, cycles */
} gscl_reference_splat;

typedef struct gscl_reference {
    int blend, colours, channels, opacity, texture; /* as in gscl_kernel_options */
    double support;                                 /* cut-off of q: the format's, or GSCL_REFERENCE_NO_CUT */
    double floor; /* subtracted from each Gaussian: exp(-support), or 0 with GSCL_REFERENCE_NO_CUT */
    double background[4];
    size_t count;
    gscl_reference_splat *splats;
} gscl_reference;

/* Pixels x0 <= x < x1 and y0 <= y < y1. */
typedef struct gscl_rectangle {
    int x0, y0, x1, y1;
} gscl_rectangle;

/* `params`: count * GSCL_PARAMS parameters; `cut`: Gaussians are cut off as the format defines. */
gscl_result gscl_reference_create(gscl_reference *reference, const gscl_kernel_options *options, const float *params,
                                  size_t count, const float background[4], bool cut);
/* Accepts a reference that was zeroed and never created. */
void gscl_reference_free(gscl_reference *reference);
/* Replaces the parameters (GSCL_PARAMS) of splat `i`. */
void gscl_reference_replace(gscl_reference *reference, size_t i, const double *params);
/* The pixels that splat `i` may touch, within `bounds`. */
gscl_rectangle gscl_reference_box(const gscl_reference *reference, size_t i, gscl_rectangle bounds);
/* Draws a part of the image: planes of the part's size.  `weights` is scratch, one plane. */
void gscl_reference_draw(const gscl_reference *reference, gscl_rectangle part, double *planes, double *weights);

#endif
