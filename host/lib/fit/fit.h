/* The fit: splats, their gradients and Adam on the device, against a pyramid of the image.
 *
 * The caller drives it: set a level, add splats, take steps.  Everything but the births between steps
 * stays on the device. */
#ifndef GSCL_LIB_FIT_H
#define GSCL_LIB_FIT_H

#include "image/flat_background.h"
#include "decode/renderer.h"
#include "fit/ssim_loss.h"

#define GSCL_MAX_LEVELS 15 /* 16384 pixels down to 1 */

typedef struct gscl_fit {
    gscl_context *context;
    gscl_renderer renderer;
    gscl_limits limits;
    uint32_t width, height;      /* of the full-size image */
    int first_level, last_level; /* of the pyramid that exists; 0 is full size */
    int level;
    gscl_buffer levels[GSCL_MAX_LEVELS];
    gscl_buffer gradients, first_moment, second_moment, ages, slots, tile_loss, wakes, loss, error;
    float quiet;     /* loss a pixel, below which a tile sits out steps */
    bool has_losses; /* tile_loss is of this level */
    cl_int step;     /* since tiles were last woken */
    size_t capacity; /* splats that fit in the buffers */
    int steps_since_check;
    float background[4];
    gscl_flat_background ground; /* where the picture has one, the background is its colour, not the mean of all */
    float ssim_weight;           /* of the SSIM term where the loss is EXTERNAL */
    gscl_ssim ssim;
    gscl_buffer derivative; /* of the loss by the picture */
    gscl_buffer adapted;    /* what gscl_fit_adapt makes of the first level's target; else empty */
} gscl_fit;

/* Builds the pyramid of `planes` (renderer channels; the image at level `first_level`), down to a shorter
 * side of about 32 pixels; where options->weighted, each level gets a plane of weights (gscl_ssim_weights) besides.
 * `fit` may hold anything before. */
gscl_result gscl_fit_create(gscl_fit *fit, gscl_context *context, const gscl_kernel_options *options, uint32_t width,
                            uint32_t height, int first_level, const float *planes);
/* Takes the colour of the picture's ground for the background; how large and how many splats become, and which tiles
 * rest, goes by the rest of the picture. */
gscl_result gscl_fit_set_flat_background(gscl_fit *fit, const gscl_flat_background *ground);
/* Accepts a fit that was zeroed and never created. */
void gscl_fit_free(gscl_fit *fit);

uint32_t gscl_fit_level_width(const gscl_fit *fit);
uint32_t gscl_fit_level_height(const gscl_fit *fit);

/* The stage of an encode that fitting at the current level is. */
gscl_stage_id gscl_fit_stage(const gscl_fit *fit);

/* Pixels of a level. */
size_t gscl_fit_level_pixels(const gscl_fit *fit, int level);
/* Halves one plane of an image of this level's size into an image of the next one's. */
gscl_result gscl_fit_halve(gscl_fit *fit, int level, size_t channel, const gscl_buffer *from, const gscl_buffer *to);

/* Where errors are weighted (fit_weights.c).  Puts a plane of weights behind each level's target; part of creation. */
gscl_result gscl_fit_build_weights(gscl_fit *fit);
/* Adapts target and weights of the first level to what the splats draw now, so that squared error leads where MS-SSIM
 * does (cl/ssim.cl).  Does nothing where errors are not weighted, at other levels, or when the image is too small. */
gscl_result gscl_fit_adapt(gscl_fit *fit);
/* What the splats are to look like at this level: the target's planes and, where errors are weighted, the weights. */
const gscl_buffer *gscl_fit_weighted_target(const gscl_fit *fit);

/* What level `level` shows and the next smaller one, which must exist, does not, in the tiles that show most (a hundredth
 * left out): mean squared difference per sample from that level's pixels and slopes (fit_detail.c). */
gscl_result gscl_fit_level_residual(gscl_fit *fit, int level, double *detail);
/* Works on this level (clamped to those that exist) from now on. */
gscl_result gscl_fit_set_level(gscl_fit *fit, int level);
/* Appends splats (GSCL_PARAMS floats each) with fresh optimiser state. */
gscl_result gscl_fit_append(gscl_fit *fit, const float *params, size_t count);
/* Replaces all splats; the optimiser starts afresh. */
gscl_result gscl_fit_replace(gscl_fit *fit, const float *params, size_t count);
/* Puts the splats, with their optimiser state, into a new order: place i < kept takes splat order[i], the others
 * are dropped. */
gscl_result gscl_fit_reorder(gscl_fit *fit, const size_t *order, size_t kept);
/* Reads all parameters (renderer.count * GSCL_PARAMS floats). */
gscl_result gscl_fit_read(gscl_fit *fit, float *params);
/* One step of Adam. `rate` multiplies the learning rates. */
gscl_result gscl_fit_step(gscl_fit *fit, float rate);
/* The parts of a step: gradients of what is projected, into fit->gradients; and Adam on parameters that may be others
 * than those drawn (`params`: count * GSCL_PARAMS floats on the device), which leaves them projected. */
gscl_result gscl_fit_differentiate(gscl_fit *fit);
gscl_result gscl_fit_adam(gscl_fit *fit, const gscl_buffer *params, float rate);
/* Gradients of the loss at the current parameters (count * GSCL_PARAMS floats), without a step. */
gscl_result gscl_fit_gradients(gscl_fit *fit, float *gradients);
/* Mean loss per sample of the last step (weighted: no MSE). */
gscl_result gscl_fit_loss(gscl_fit *fit, double *loss);
/* Draws the splats as they are now (through the quantiser) and reads the squared error of each pixel of the
 * level, added over channels, times its weight. */
gscl_result gscl_fit_error(gscl_fit *fit, float *error);
/* Draws the splats likewise: the sum over the level. */
gscl_result gscl_fit_drawn_error(gscl_fit *fit, double *sum);
/* Sum of (weighted) squared errors of planes (of the level's size) against the level's target. */
gscl_result gscl_fit_error_sum(gscl_fit *fit, const gscl_buffer *planes, double *sum);
/* Mean squared error of planes of the first level's size against the image, per sample and not weighted. */
gscl_result gscl_fit_mse_against_source(gscl_fit *fit, const gscl_buffer *planes, double *mse);
/* Reads the level's target planes. */
gscl_result gscl_fit_target(gscl_fit *fit, float *planes);

#endif
