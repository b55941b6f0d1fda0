/* The visual loss on the device (cl/visual.cl): squared error plus the weighted sum of errors in luma of SSIMULACRA
 * 2.1, its derivative, and a local quadratic model of it.
 *
 * Its colours are left out, which squared error holds: with them the figures of SSIMULACRA 2 are the same, and the loss
 * takes three times as long.  So are its two finest scales, which are a few percent of the sum in pictures of up to 0.2
 * bits a pixel and nine tenths of the time: half the size earns half a point at 0.18 bits, and nothing below 0.07. */
#ifndef GSCL_LIB_FIT_VISUAL_LOSS_H
#define GSCL_LIB_FIT_VISUAL_LOSS_H

#include "cl/structs.h"
#include "fit/pyramid.h"
#include "runtime/launch.h"

/* Scales are 1, 1/2, ... 1/16; the sixth of SSIMULACRA 2 has next to no weight. */
#define GSCL_VISUAL_SCALES 5
#define GSCL_VISUAL_FIRST_SCALE 2 /* with weights */

/* Zeroed: empty.  Kept between calls for the same pyramid and options.  Planes of all scales lie in one buffer (cl/visual.cl);
 * padded ones have margins of zeros, which kernels never overwrite. */
typedef struct gscl_visual {
    int level; /* of the pyramid, whose target the buffers hold */
    bool has_target;
    int first;                                 /* scale that has terms */
    gscl_visual_scales scales;                 /* the first and those behind it; none where they would be too small */
    gscl_buffer target;                        /* luma, padded */
    gscl_buffer statistics;                    /* the target's mean and variance, plain */
    gscl_buffer luminance, luma;               /* of the rendering: plain, and padded */
    gscl_buffer rows, maps;                    /* four padded planes each */
    gscl_buffer moments, direct, by_luminance; /* three and twice two plain planes */
    gscl_buffer larger[GSCL_VISUAL_SCALES];    /* luminance between the level and the first scale */
    gscl_buffer row_sums, shares, losses, loss;
} gscl_visual;

/* An image of the size of a level of the pyramid, beside that level. */
typedef struct gscl_visual_comparison {
    const gscl_pyramid *pyramid;
    const gscl_kernel_options *options;
    int level;
    const gscl_buffer *rendering; /* planes like the level's */
    float
        share; /* of the visual loss beside squared error.  At 1, a sum of errors of SSIMULACRA 2 that is lower by 1 is
                    worth as much as a mean squared error per sample that is lower by 1/3000 */
} gscl_visual_comparison;

/* Writes the derivative by the rendering of half the sum of squared errors plus the visual loss into `derivative`
 * (planes like the rendering, which it makes).  Images with a side below 8 pixels at a quarter of the size have no
 * visual loss. */
gscl_result gscl_visual_derivative(gscl_visual *visual, const gscl_visual_comparison *comparison,
                                   gscl_buffer *derivative);
/* Writes the quadratic model into two planes of `model`, behind as many as the rendering has: the weight of the squared
 * error of luma, and the target of luma.  `curvature`: factor on the curvature, which is an upper bound for changes of
 * one splat at 1; the lower, the further changes go that the model asks for. */
gscl_result gscl_visual_model(gscl_visual *visual, const gscl_visual_comparison *comparison, float curvature,
                              gscl_buffer *model);
/* Reads the visual loss of the last call, in the unit of half the sum of squared errors. */
gscl_result gscl_visual_read_loss(const gscl_visual *visual, gscl_context *context, double *loss);
/* Accepts a zeroed object. */
void gscl_visual_free(gscl_visual *visual);

#endif
