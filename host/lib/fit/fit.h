/* The fit: gradient descent on splats on the device, against a pyramid of the image.
 *
 * The caller drives it: set a level, add splats, take steps.  Between steps the splats stay on the device.  The
 * functions below are grouped by the file that defines them. */
#ifndef GSCL_LIB_FIT_H
#define GSCL_LIB_FIT_H

#include "cl/structs.h"
#include "decode/renderer.h"
#include "fit/pyramid.h"
#include "fit/ssim_loss.h"
#include "fit/tile_skip.h"
#include "fit/visual_loss.h"
#include "image/flat_background.h"

struct gscl_fit_readings {
    gscl_fit_control control;
    int32_t links;       /* that the splats need */
    float squared_error; /* gscl_fit_begin_squared_error */
};

typedef struct gscl_fit {
    gscl_context *context;
    gscl_renderer renderer; /* the splats, projected at the current level */
    gscl_pyramid pyramid;   /* of the source */
    int level;              /* the current one */
    int phase;              /* the first row of the level that is drawn, where not all are */

    /* Optimiser: `capacity` splats fit in these buffers. */
    size_t capacity;
    gscl_buffer gradients, first_moment, second_moment, ages;
    size_t fixed; /* the first splats, which steps do not change */
    gscl_limits limits;

    /* The lists of the tiles, which the renderer holds, and the gradients before they are summed: a slot for each entry
     * of a list, and the links of splats to theirs (cl/links.cl, cl/slots.cl). */
    gscl_buffer gradient_slots;
    gscl_links links;
    bool has_old_lists;      /* of other splats, or of another level */
    bool has_known_lengths;  /* the lengths of the lists were read, but for those of splats that were appended since */
    int32_t known_splats;    /* then: the splats of these lists, at least one */
    int steps_since_bin;     /* steps with the present lists */
    int steps_since_control; /* steps since the device followed their lengths (gscl_fit_control) */
    int steps_since_wait;    /* steps since the host read them */
    int max_wait;            /* steps after which it reads them again, at the latest; 0: it has not yet */
    gscl_tile_skip skip;

    float background[4];
    gscl_flat_background flat; /* of the image, if it has one; `background` is then its colour, else the mean colour */

    gscl_buffer tile_loss;             /* of the last step, of each tile */
    gscl_buffer loss_parts, low_parts; /* scratch: sums of parts of it, and low splats of parts of them */
    gscl_buffer control;               /* gscl_fit_control */
    double known_loss;                 /* mean loss per sample of a step, when the host last read it; 0: not yet */
    double known_low_splats;           /* gscl_fit_control.low_splats of that time */
    struct gscl_fit_readings *reading; /* where copies from the device go that are not waited for */
    gscl_buffer error;                 /* scratch: a plane of squared errors, or a density of new splats */
    gscl_buffer error_sums;            /* scratch: sums of its parts */
    gscl_buffer row_sums;              /* scratch: a plane of its box sums along the rows */
    gscl_buffer distortion;            /* gscl_fit_begin_distortion: a float */
    gscl_buffer density_total, column_weights, group_weights; /* sums of a density (fit/placement.h) */

    float ssim_weight;  /* of the SSIM term where the loss is EXTERNAL */
    float visual_share; /* of the visual loss beside squared error where errors are weighted by it; 0: none */
    gscl_ssim ssim;
    gscl_buffer derivative;     /* of the loss by the rendering, where the loss is EXTERNAL */
    gscl_buffer adapted_target; /* of the first level (gscl_fit_adapt_target), or empty */

    gscl_visual visual;
    int model_level; /* of the pyramid, whose weights are a model (gscl_fit_renew_model), or -1: none */
} gscl_fit;

/* ---- fit.c: the state and its level ---- */

/* Builds the pyramid of `planes` (renderer channels; the image at level `first_level`), with planes of weights where
 * options->weighted.  `fit` may hold anything before. */
gscl_result gscl_fit_create(gscl_fit *fit, gscl_context *context, const gscl_kernel_options *options, uint32_t width,
                            uint32_t height, int first_level, const float *planes);
/* Accepts a fit that was zeroed and never created. */
void gscl_fit_free(gscl_fit *fit);

/* Uses the colour of a flat background for the background of the splats.  The size and number of splats and the
 * skipping of tiles then depend on the other part of the image. */
gscl_result gscl_fit_set_flat_background(gscl_fit *fit, const gscl_flat_background *flat);

/* Makes this level (clamped to those that exist) the current one. */
gscl_result gscl_fit_set_level(gscl_fit *fit, int level);
/* Draws every `step`-th row of the level from now on, where it has enough of them; 1: all. */
gscl_result gscl_fit_set_rows(gscl_fit *fit, int step);
/* Draws the rows after the present ones, in turn, from the next projection of the splats on, which need new lists. */
void gscl_fit_next_rows(gscl_fit *fit);
/* Releases what steps and errors need and make again: gradient slots, links and a plane of errors; and the smaller
 * levels, which gscl_fit_set_level makes again.  In passes over a large picture these would take a fifth of the memory. */
void gscl_fit_release_scratch(gscl_fit *fit);
/* Size of the current level in pixels. */
uint32_t gscl_fit_level_width(const gscl_fit *fit);
uint32_t gscl_fit_level_height(const gscl_fit *fit);
size_t gscl_fit_level_pixels(const gscl_fit *fit);
/* The stage of an encode that fitting at this level (clamped likewise) is. */
gscl_stage_id gscl_fit_stage(const gscl_fit *fit, int level);

/* ---- fit_target.c: what splats are compared with ---- */

/* Draws the projected splats at the current level into renderer.image. */
gscl_result gscl_fit_render(gscl_fit *fit);
/* Adapts target and weights of the first level to the current rendering, so that the gradient of squared error
 * approximates that of MS-SSIM (fit/ssim_weights.h).  Has no effect where errors are not weighted, at other levels, or
 * if there is one level only. */
gscl_result gscl_fit_adapt_target(gscl_fit *fit);
/* Makes a quadratic model of squared error and the visual loss at the current rendering (fit/visual_loss.h): the weights
 * of this level.  Has no effect but where gscl_fit_has_visual_loss. */
gscl_result gscl_fit_renew_model(gscl_fit *fit);
/* Likewise, at planes of the level's size and with the curvature of gscl_visual_model. */
gscl_result gscl_fit_renew_model_at(gscl_fit *fit, const gscl_buffer *rendering, float curvature);
/* Whether the loss has a visual part: with GSCL_WEIGHTED_LUMA, until it is ended. */
bool gscl_fit_has_visual_loss(const gscl_fit *fit);
/* From now on the loss is squared error alone. */
gscl_result gscl_fit_end_visual_loss(gscl_fit *fit);
/* The current level's target: its planes and, where errors are weighted, the weights. */
const gscl_buffer *gscl_fit_weighted_target(const gscl_fit *fit);

/* ---- fit_splats.c: the splats and the state of the optimiser for each ---- */

/* Appends splats (GSCL_PARAMS floats each) with new optimiser state. */
gscl_result gscl_fit_append(gscl_fit *fit, const float *params, size_t count);
/* The same in two parts, between which the device writes the parameters of the new splats: behind the others. */
gscl_result gscl_fit_begin_append(gscl_fit *fit, size_t count);
gscl_result gscl_fit_end_append(gscl_fit *fit, size_t count);
/* Replaces all splats, with new optimiser state, and the background. */
gscl_result gscl_fit_replace(gscl_fit *fit, const float *params, size_t count, const float *background);
/* Permutes the splats, with their optimiser state: place i < kept receives splat order[i].  The others are removed. */
gscl_result gscl_fit_reorder(gscl_fit *fit, const size_t *order, size_t kept);
/* Reads all parameters (renderer.count * GSCL_PARAMS floats). */
gscl_result gscl_fit_read(gscl_fit *fit, float *params);

/* ---- fit_bin.c ---- */

/* Fills the lists of the tiles and links their entries.  `exact` as in gscl_renderer_bin: needed where !has_known_lengths. */
gscl_result gscl_fit_bin(gscl_fit *fit, bool exact);
/* Starts to read what the host follows of the fit, without waiting: the loss, and the lengths of the lists, which are those
 * of the present splats. */
gscl_result gscl_fit_begin_readings(gscl_fit *fit);
/* Takes these after a wait, and enlarges the lists and the room for links where they are short of room.  Where *state is not
 * KEPT, they must be filled again. */
gscl_result gscl_fit_end_readings(gscl_fit *fit, gscl_lists_state *state);
/* Makes room for the lists of all splats once `count` are appended, as far as their lengths can be foreseen. */
gscl_result gscl_fit_expect_splats(gscl_fit *fit, size_t count);

/* ---- fit_step.c: gradients and the optimiser ---- */

/* One step of Adam.  `rate` multiplies the learning rates.  The lists of the tiles are those of a few steps ago: what a
 * splat gained since then at its outline is not drawn, and the step is shorter by the time of filling them.
 * It sees every `row_step`-th row of the level, and others when the lists are filled again: two steps at 2 take the time of
 * one at 1.  A loss that is EXTERNAL needs all rows. */
gscl_result gscl_fit_step(gscl_fit *fit, float rate, int row_step);
/* The steps for which the lists of the tiles stay as they are. */
int gscl_fit_bin_interval(const gscl_fit *fit);
/* First part of a step: gradients of the projected splats into fit->gradients. */
gscl_result gscl_fit_differentiate(gscl_fit *fit);
/* Second part of a step: Adam on `params` (count * GSCL_PARAMS floats on the device), which may be other parameters
 * than the projected ones.  Projects the result. */
gscl_result gscl_fit_adam(gscl_fit *fit, const gscl_buffer *params, float rate);
/* Gradients of the loss at the current parameters (count * GSCL_PARAMS floats), without a step. */
gscl_result gscl_fit_gradients(gscl_fit *fit, float *gradients);

/* ---- fit_control.c: what the device follows of a fit (gscl_fit_control) ---- */

/* Sums the mean loss of the last step into it, without waiting. */
gscl_result gscl_fit_sum_loss(gscl_fit *fit);
/* Bounds the tile occupancy by the present lists and counts low splats; where the last step `has_loss`, sums it and sets the
 * threshold of skipped tiles by it. */
gscl_result gscl_fit_follow(gscl_fit *fit, bool has_loss);

/* ---- fit_error.c: losses and errors ---- */

/* Mean loss per sample of the last step; with weights it is no MSE.  fit->known_loss is that of an earlier step. */
gscl_result gscl_fit_loss(gscl_fit *fit, double *loss);
/* Renders the current splats (through the quantiser) and writes the squared error of each pixel of the level, added over
 * channels and weighted, into fit->error, without waiting. */
gscl_result gscl_fit_begin_error(gscl_fit *fit);
/* The same, and reads it. */
gscl_result gscl_fit_error(gscl_fit *fit, float *error);
/* Sums fit->error into fit->density_total, without waiting. */
gscl_result gscl_fit_sum_error(gscl_fit *fit);
/* Renders likewise; the sum over the level, or what gscl_fit_distortion says. */
gscl_result gscl_fit_rendering_error(gscl_fit *fit, double *sum);
/* The sum that rate-distortion passes trade against bits, at planes of the level's size: (weighted) squared errors against the
 * level's target or, after gscl_fit_renew_model_at them, squared errors plus twice the visual loss. */
gscl_result gscl_fit_distortion(gscl_fit *fit, const gscl_buffer *planes, double *sum);
/* The same into fit->distortion, without waiting. */
gscl_result gscl_fit_begin_distortion(gscl_fit *fit, const gscl_buffer *planes);
/* Sum of squared errors of planes of the level's size against the level, not weighted. */
gscl_result gscl_fit_squared_error(gscl_fit *fit, const gscl_buffer *planes, double *sum);
/* The same without waiting: fit->reading->squared_error, after a wait. */
gscl_result gscl_fit_begin_squared_error(gscl_fit *fit, const gscl_buffer *planes);
/* Mean squared error of planes of the first level's size against the source, per sample and not weighted. */
gscl_result gscl_fit_mse_against_source(gscl_fit *fit, const gscl_buffer *planes, double *mse);

/* ---- level_residual.c ---- */

/* Starts to read the squared residual of each pixel of `level` after prediction from the pixels and slopes of the next smaller
 * level, which must exist, without waiting.  The caller releases *map, which is NULL before, after a wait or by
 * gscl_release_after_copies. */
gscl_result gscl_fit_begin_level_residual(gscl_fit *fit, int level, float **map);
/* After a wait, their mean per sample: the largest mean of a tile, without the tiles that gscl_fit_tunables.residual_outliers
 * leaves out. */
double gscl_fit_level_residual(const gscl_fit *fit, int level, float *map);

#endif
