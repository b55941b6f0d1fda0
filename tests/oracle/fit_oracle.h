/* The loss of the fit in double precision, and its gradient by central differences. */
#ifndef GSCL_FIT_ORACLE_H
#define GSCL_FIT_ORACLE_H

#include <stdbool.h>
#include <stddef.h>

#include "oracle.h"

/* The order of a splat's parameters (cl/constants.h): x, y, ln s1, ln s2, theta, logit of the opacity, four
 * colours, and of the wave: cycles per pixel along x and y, phase in cycles, amplitude. */
#define ORACLE_PARAMS 14

typedef struct {
    oracle_blend blend;
    int colours, alpha_channel; /* coded channels: their sum */
    bool opacity, texture;
    bool absolute;        /* loss L1, else L2 */
    bool stepped;         /* no splat is rotated: kernels step a Gaussian's rows by multiplication; for bounds */
    bool rounds_products; /* the device has no fma, and rounds a product before it adds to it; for bounds */
    int level;            /* of the pyramid, at which the splats are drawn */
    int width, height;    /* of that level */
    double background[ORACLE_CHANNELS];
    const double *target;  /* channels planes of width * height */
    const double *weights; /* of pixels' squared errors; NULL: all 1 */
    /* Where not NULL, added to the squared errors: of luma, weighted. */
    const double *luma_weights, *luma_target;
} oracle_fit;

/* Draws `count` splats of ORACLE_PARAMS parameters into planes. */
void oracle_fit_draw(const oracle_fit *fit, const double *params, size_t count, double *planes);

/* The loss whose gradient the fit follows: 4^level times half the sum of squared errors (L1: the sum of absolute
 * errors) over all samples of the level, each times its pixel's weight, with the weighted squared errors of luma. */
double oracle_fit_loss(const oracle_fit *fit, const double *params, size_t count);

/* The loss's derivative by each parameter, by central differences over five points, for every `stride`th splat with the
 * last among them, and 0 for the others.  A weight has kinks: at the cut q = 7 and at the alpha blend's clamp.  There
 * the derivative is that of the side on which each pixel lies. */
void oracle_fit_gradient(const oracle_fit *fit, const double *params, size_t count, size_t stride, double *gradient);

/* Turns one splat's gradient, or its bounds, into those of kernels for other shapes: splats that are not rotated have no
 * angle, and the two axes of a circle share one derivative, which is stored for both. */
void oracle_shape_gradient(double *gradient, bool rotated, bool isotropic);

/* The change of a parameter that changes the rendering much: the length of an axis, or the angle that moves its end by
 * the length of the other. */
double oracle_natural_step(const oracle_fit *fit, const double *params, size_t parameter);

/* Bounds on the errors of single precision against oracle_fit_draw and oracle_fit_gradient (squared errors, no textures):
 * the rounding errors of each operation, propagated to the result (fit_bounds.c).  `planes` and `gradient` are as
 * there. */
void oracle_fit_bounds(const oracle_fit *fit, const double *params, size_t count, double *planes, double *gradient);

/* Weights of squared errors for MS-SSIM, by definition (cl/ssim.cl), from the levels 1 to 3 of the image's pyramid, or the
 * last where it has fewer.  `planes`: `channels` planes of width * height, changed by the call. */
void oracle_ssim_weights(double *planes, int channels, int width, int height, int last_level, double *weights);

/* The target and, behind it, the weights that gscl_fit_adapt_target makes from a rendering.  `planes` and `rendering` are
 * changed by the call. */
void oracle_ssim_adapt(double *planes, double *rendering, int channels, int width, int height, int last_level,
                       double *adapted);

#endif
