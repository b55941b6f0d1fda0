#include <math.h>

#include "cl/constants.h"
#include "fit/fit.h"
#include "fit/tunables.h"

/* What makes the mean per sample of the sum of the tiles' losses. */
static float loss_scale(const gscl_fit *f) {
    return 1.0f / ((float)gscl_renderer_plane(&f->renderer) * (float)f->renderer.channels);
}

/* Half the height of the outline of a splat below which it counts as low: drawn rows. */
static float low_height(const gscl_fit *f) {
    return gscl_fit_tunables.low_axis * sqrtf(2.0f * GSCL_SUPPORT) * f->renderer.view.row_scale;
}

/* Sums losses and counts low splats by a work-group for each part of them. */
static gscl_result launch_parts(gscl_fit *f, size_t parts) {
    const gscl_renderer *r = &f->renderer;
    const int32_t tiles = (int32_t)gscl_renderer_tiles(r);
    const float height = low_height(f);
    gscl_kernel *kernel;
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->loss_parts, parts * sizeof(float)));
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->low_parts, parts * sizeof(float)));
    GSCL_TRY(gscl_image_kernel(f->context, "begin_control", &kernel));
    return GSCL_LAUNCH(f->context, kernel, parts, gscl_sum_group_size(f->context), GSCL_ARG_BUFFER(f->tile_loss),
                       GSCL_ARG(tiles), GSCL_ARG_BUFFER(r->ellipse_bounds), GSCL_ARG(r->count), GSCL_ARG(height),
                       GSCL_ARG_BUFFER(f->loss_parts), GSCL_ARG_BUFFER(f->low_parts));
}

/* Where there are so many tiles or splats that the one work-group which sums them would take long, makes sums of *parts parts
 * first; *parts is 0 otherwise. */
static gscl_result make_parts(gscl_fit *f, int32_t *parts) {
    const size_t tiles = gscl_renderer_tiles(&f->renderer), splats = (size_t)f->renderer.count;
    const size_t most = tiles > splats ? tiles : splats;
    *parts = 0;
    if (gscl_sum_group_size(f->context) == 1 || most <= (size_t)gscl_fit_tunables.gpu_summed_at_once)
        return GSCL_OK;
    *parts = (int32_t)gscl_groups(most, GSCL_CONTROL_PART);
    return launch_parts(f, (size_t)*parts);
}

/* The losses to sum, of which there are *count. */
static const gscl_buffer *losses_of(const gscl_fit *f, int32_t parts, int32_t *count) {
    *count = parts > 0 ? parts : (int32_t)gscl_renderer_tiles(&f->renderer);
    return parts > 0 ? &f->loss_parts : &f->tile_loss;
}

gscl_result gscl_fit_sum_loss(gscl_fit *f) {
    const float scale = loss_scale(f);
    int32_t parts, count;
    gscl_kernel *kernel;
    GSCL_TRY(make_parts(f, &parts));
    const gscl_buffer *losses = losses_of(f, parts, &count);
    GSCL_TRY(gscl_image_kernel(f->context, "sum_loss", &kernel));
    return GSCL_LAUNCH(f->context, kernel, 1, gscl_sum_group_size(f->context), GSCL_ARG_BUFFER(*losses),
                       GSCL_ARG(count), GSCL_ARG(scale), GSCL_ARG_BUFFER(f->control));
}

/* The part of the tiles that is not flat background. */
static double non_flat_tiles(const gscl_fit *f) {
    return fmax(1 - f->flat.tiles, gscl_fit_tunables.min_non_flat_tiles);
}

/* The number of entries of all lists above which the bound on the longest axis is reduced. */
static double max_entries(const gscl_fit *f) {
    const gscl_renderer *r = &f->renderer;
    double limit = r->options.blend == GSCL_ALPHA      ? gscl_fit_tunables.max_occupancy_of_alpha
                   : f->level > f->pyramid.first_level ? gscl_fit_tunables.max_occupancy_of_smaller_levels
                                                       : gscl_fit_tunables.max_occupancy;
    double tiles = (double)gscl_renderer_tiles(r);
    return non_flat_tiles(f) * limit * tiles + gscl_fit_tunables.tiles_of_small_splat * r->count;
}

gscl_result gscl_fit_follow(gscl_fit *f, bool has_loss) {
    const gscl_renderer *r = &f->renderer;
    gscl_control_settings settings = {.max_entries = (float)max_entries(f),
                                      .reduction = gscl_fit_tunables.axis_reduction,
                                      .log_min = f->limits.log_min,
                                      .loss_scale = loss_scale(f),
                                      .threshold_per_loss = gscl_tile_skip_share(r->channels, non_flat_tiles(f)),
                                      .splats = r->count,
                                      .low_height = low_height(f)};
    gscl_kernel *kernel;
    GSCL_TRY(make_parts(f, &settings.low_parts));
    const gscl_buffer *losses = losses_of(f, settings.low_parts, &settings.losses);
    if (!has_loss)
        settings.losses = 0;
    GSCL_TRY(gscl_image_kernel(f->context, "control_fit", &kernel));
    return GSCL_LAUNCH(f->context, kernel, 1, gscl_sum_group_size(f->context), GSCL_ARG_BUFFER(r->row_totals),
                       GSCL_ARG(r->view.tiles_y), GSCL_ARG_BUFFER(r->ellipse_bounds), GSCL_ARG_BUFFER(f->low_parts),
                       GSCL_ARG_BUFFER(*losses), GSCL_ARG(settings), GSCL_ARG_BUFFER(f->control));
}
