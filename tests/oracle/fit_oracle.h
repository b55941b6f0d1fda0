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
    bool absolute;     /* loss L1, else L2 */
    bool stepped;      /* no splat is turned: kernels step a Gaussian's rows by multiplication; for bounds */
    int level;         /* of the pyramid that is drawn */
    int width, height; /* of that level */
    double background[ORACLE_CHANNELS];
    const double *target;  /* channels planes of width * height */
    const double *weights; /* of pixels' squared errors; NULL: all 1 */
} oracle_fit;

/* Draws `count` splats of ORACLE_PARAMS parameters into planes. */
void oracle_fit_draw(const oracle_fit *fit, const double *params, size_t count, double *planes);

/* What the fit's gradient is the gradient of: 4^level times half the sum of squared errors (L1: the sum of absolute
 * errors) over all samples of the level, each times its pixel's weight. */
double oracle_fit_loss(const oracle_fit *fit, const double *params, size_t count);

/* The loss's derivative by each parameter, by central differences over five points; of every `stride`th splat, the
 * last among them, 0 for the others.  Where a weight has a kink - the cut at q = 7, the alpha blend's clamp - it is the derivative of the side on
 * which each pixel stands. */
void oracle_fit_gradient(const oracle_fit *fit, const double *params, size_t count, size_t stride, double *gradient);

/* What is left of one splat's gradient, or of its bounds, where kernels do not turn splats: no angle; and of a circle's
 * one axis the whole, in both places. */
void oracle_shape_gradient(double *gradient, bool turned, bool round);

/* How far a parameter must go to change much in the picture: an axis's length, or what moves its end by so much. */
double oracle_natural_step(const oracle_fit *fit, const double *params, size_t parameter);

/* How far single precision may be from oracle_fit_draw and oracle_fit_gradient (squared errors, no textures): rounding
 * errors of each operation, followed to the result (fit_bounds.c).  `planes` as those drawn, `gradient` as above. */
void oracle_fit_bounds(const oracle_fit *fit, const double *params, size_t count, double *planes, double *gradient);

/* What squared errors count towards MS-SSIM, by definition (cl/ssim.cl): from the levels 1 to 3 of the image's pyramid, or
 * the last where it has fewer.  `planes`: `channels` planes of width * height, changed by the call. */
void oracle_ssim_weights(double *planes, int channels, int width, int height, int last_level, double *weights);

/* The target and, behind it, the weights that gscl_fit_adapt_target makes from the rendering `picture`.  `planes` and
 * `picture` are changed by the call. */
void oracle_ssim_adapt(double *planes, double *picture, int channels, int width, int height, int last_level,
                       double *adapted);

#endif
