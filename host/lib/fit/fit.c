#include "fit/fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "fit/ssim_weights.h"
#include "fit/tunables.h"
#include "runtime/elementary.h"
#include "runtime/queue.h"
#include "runtime/timing.h"

#define SSIM_WEIGHT 0.5f /* paper, section 3.4 */

/* The mean of each plane: the background that fits best where no splat reaches. */
static void mean_colour(const float *planes, int channels, size_t pixels, float background[4]) {
    for (int k = 0; k < channels; k++) {
        double sum = 0;
        for (size_t i = 0; i < pixels; i++)
            sum += planes[(size_t)k * pixels + i];
        background[k] = (float)(sum / (double)pixels);
    }
}

static gscl_limits first_limits(uint32_t width, uint32_t height, int blend) {
    float longer = (float)(width > height ? width : height);
    float log_min = (float)gscl_ln(gscl_fit_tunables.min_axis);
    return (gscl_limits){.width = (float)width,
                         .height = (float)height,
                         .log_min = log_min,
                         .log_max = fmaxf((float)gscl_ln(longer), log_min),
                         .log_aspect = (float)gscl_ln(gscl_fit_tunables.max_aspect),
                         .colour_min = blend == GSCL_SUM ? -1.0f : 0.0f,
                         .colour_max = 1.0f};
}

gscl_result gscl_fit_create(gscl_fit *f, gscl_context *context, const gscl_kernel_options *options, uint32_t width,
                            uint32_t height, int first_level, const float *planes) {
    memset(f, 0, sizeof *f);
    gscl_stage(context, GSCL_STAGE_PYRAMID);
    f->context = context;
    f->ssim_weight = SSIM_WEIGHT;
    f->visual_share = gscl_fit_tunables.visual_share;
    f->model_level = -1;
    f->limits = first_limits(width, height, options->blend);
    GSCL_TRY(gscl_renderer_create(&f->renderer, context, options));
    f->reading = calloc(1, sizeof *f->reading);
    if (!f->reading)
        return gscl_fail_memory(context);
    f->reading->control.log_max = f->limits.log_max;
    GSCL_TRY(gscl_buffer_reserve(context, &f->control, sizeof f->reading->control));
    GSCL_TRY(gscl_buffer_write_async(context, &f->control, 0, &f->reading->control, sizeof f->reading->control));
    GSCL_TRY(gscl_pyramid_create(&f->pyramid, context, width, height, first_level, f->renderer.channels,
                                 options->weighted, planes));
    if (options->weighted == GSCL_WEIGHTED_PIXELS)
        GSCL_TRY(gscl_weights_build(&f->pyramid, &f->ssim, options));
    gscl_flush(context);
    mean_colour(planes, f->renderer.channels, gscl_pyramid_pixels(&f->pyramid, first_level), f->background);
    GSCL_TRY(gscl_renderer_set_splats(&f->renderer, NULL, 0, f->background));
    return gscl_fit_set_level(f, first_level);
}

void gscl_fit_free(gscl_fit *f) {
    gscl_renderer_free(&f->renderer);
    gscl_pyramid_free(&f->pyramid);
    gscl_tile_skip_free(&f->skip);
    gscl_ssim_free(&f->ssim);
    gscl_visual_free(&f->visual);
    gscl_buffer *buffers[] = {&f->gradients,      &f->first_moment,   &f->second_moment, &f->ages,
                              &f->gradient_slots, &f->links.links,    &f->links.grids,   &f->links.block_links,
                              &f->links.needed,   &f->tile_loss,      &f->loss_parts,    &f->low_parts,
                              &f->control,        &f->error,          &f->error_sums,    &f->row_sums,
                              &f->density_total,  &f->column_weights, &f->group_weights, &f->distortion,
                              &f->derivative,     &f->adapted_target};
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++)
        gscl_buffer_free(buffers[i]);
    gscl_release_after_copies(f->context, f->reading); /* after an error the device may still write it */
    f->reading = NULL;
}

gscl_result gscl_fit_set_flat_background(gscl_fit *f, const gscl_flat_background *flat) {
    f->flat = *flat;
    memcpy(f->background, flat->colour, sizeof f->background);
    return gscl_renderer_set_splats(&f->renderer, NULL, 0, f->background);
}

void gscl_fit_release_scratch(gscl_fit *f) {
    gscl_buffer_free(&f->gradient_slots);
    gscl_buffer_free(&f->links.links);
    gscl_buffer_free(&f->error);
    gscl_buffer_free(&f->row_sums);
    gscl_pyramid_release_smaller(&f->pyramid, f->level);
    f->has_old_lists = true; /* filling them makes the slots and links again */
}

uint32_t gscl_fit_level_width(const gscl_fit *f) {
    return gscl_pyramid_width(&f->pyramid, f->level);
}
uint32_t gscl_fit_level_height(const gscl_fit *f) {
    return gscl_pyramid_height(&f->pyramid, f->level);
}
size_t gscl_fit_level_pixels(const gscl_fit *f) {
    return gscl_pyramid_pixels(&f->pyramid, f->level);
}

static int clamped_level(const gscl_fit *f, int level) {
    const gscl_pyramid *p = &f->pyramid;
    return level < p->first_level ? p->first_level : level > p->last_level ? p->last_level : level;
}

gscl_stage_id gscl_fit_stage(const gscl_fit *f, int level) {
    level = clamped_level(f, level);
    static const gscl_stage_id stages[] = {GSCL_STAGE_FIT_FULL, GSCL_STAGE_FIT_HALF, GSCL_STAGE_FIT_QUARTER,
                                           GSCL_STAGE_FIT_EIGHTH};
    return level < 4 ? stages[level] : GSCL_STAGE_FIT_SMALLER;
}

gscl_result gscl_fit_set_level(gscl_fit *f, int level) {
    level = clamped_level(f, level);
    f->level = level;
    GSCL_TRY(gscl_pyramid_restore(&f->pyramid, level));
    GSCL_TRY(gscl_renderer_set_view(&f->renderer, f->level, 0, 0, gscl_fit_level_width(f), gscl_fit_level_height(f)));
    size_t tiles = gscl_renderer_tiles(&f->renderer);
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->tile_loss, tiles * sizeof(float)));
    GSCL_TRY(gscl_tile_skip_reset(&f->skip, f->context, tiles, &f->control));
    f->has_old_lists = true;
    f->has_known_lengths = false;
    return gscl_renderer_project(&f->renderer);
}

void gscl_fit_next_rows(gscl_fit *f) {
    const int step = f->renderer.row_step;
    f->phase = (f->phase + 1) % step;
    gscl_renderer_set_rows(&f->renderer, step, f->phase);
}

gscl_result gscl_fit_set_rows(gscl_fit *f, int step) {
    gscl_renderer *r = &f->renderer;
    if (gscl_fit_level_height(f) < (uint32_t)(step * GSCL_TILE))
        step = 1;
    if (step == r->row_step)
        return GSCL_OK;
    gscl_renderer_set_rows(r, step, f->phase % step);
    GSCL_TRY(gscl_tile_skip_reset(&f->skip, f->context, gscl_renderer_tiles(r), &f->control));
    f->has_old_lists = true;
    return gscl_renderer_project(r);
}
