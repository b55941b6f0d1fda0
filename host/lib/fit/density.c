#include "fit/density.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "fit/placement.h"
#include "fit/tunables.h"
#include "image/tunables.h"
#include "runtime/elementary.h"
#include "runtime/timing.h"

#define SPLIT_FACTOR 1.6f /* the paper's released code */

/* ---- Densities ---- */

/* Number of pixels of the level outside the flat background, which need splats. */
static float non_flat_area(const gscl_fit *f) {
    const float share = fmaxf(1.0f - (float)f->flat.pixels, gscl_fit_tunables.min_non_flat_pixels);
    return share * (float)gscl_fit_level_pixels(f);
}

/* Replaces each value of the density by the sum of those at most `radius` columns and rows away; `flags`: by the number of
 * those that are not 0. */
static gscl_result launch_box_sum(gscl_fit *f, gscl_placement_settings settings, int32_t radius, int32_t flags) {
    const size_t width = (size_t)settings.width, height = (size_t)settings.height;
    gscl_kernel *kernel;
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->row_sums, width * height * sizeof(float)));
    GSCL_TRY(gscl_image_kernel(f->context, "box_rows", &kernel));
    GSCL_TRY(GSCL_LAUNCH(f->context, kernel,
                         gscl_groups(gscl_groups(width, GSCL_BOX_LENGTH) * height, GSCL_IMAGE_GROUP), GSCL_IMAGE_GROUP,
                         GSCL_ARG_BUFFER(f->error), GSCL_ARG(settings), GSCL_ARG(radius), GSCL_ARG(flags),
                         GSCL_ARG_BUFFER(f->row_sums)));
    GSCL_TRY(gscl_image_kernel(f->context, "box_columns", &kernel));
    return GSCL_LAUNCH(f->context, kernel, gscl_groups(width * gscl_groups(height, GSCL_BOX_LENGTH), GSCL_IMAGE_GROUP),
                       GSCL_IMAGE_GROUP, GSCL_ARG_BUFFER(f->row_sums), GSCL_ARG(settings), GSCL_ARG(radius),
                       GSCL_ARG_BUFFER(f->error));
}

static gscl_result launch_edge_strength(gscl_fit *f, gscl_placement_settings settings) {
    const size_t pixels = gscl_fit_level_pixels(f);
    gscl_kernel *kernel;
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->error, pixels * sizeof(float)));
    GSCL_TRY(gscl_image_kernel(f->context, "edge_strength", &kernel));
    return GSCL_LAUNCH(f->context, kernel, gscl_groups(pixels, GSCL_IMAGE_GROUP), GSCL_IMAGE_GROUP,
                       GSCL_ARG_BUFFER(f->pyramid.levels[f->level]), GSCL_ARG(settings), GSCL_ARG_BUFFER(f->error));
}

/* Makes the density of the first splats. */
static gscl_result seed_density(gscl_fit *f, gscl_placement_settings settings) {
    gscl_kernel *kernel;
    GSCL_TRY(launch_edge_strength(f, settings));
    GSCL_TRY(gscl_fit_sum_error(f));
    if (settings.has_background) {
        const float distance = sqrtf(non_flat_area(f) / (float)settings.count);
        GSCL_TRY(launch_box_sum(f, settings, (int32_t)(gscl_fit_tunables.background_distance * distance) + 1, 1));
    }
    GSCL_TRY(gscl_image_kernel(f->context, "seed_density", &kernel));
    return GSCL_LAUNCH(f->context, kernel, gscl_groups(gscl_fit_level_pixels(f), GSCL_IMAGE_GROUP), GSCL_IMAGE_GROUP,
                       GSCL_ARG_BUFFER(f->pyramid.levels[f->level]), GSCL_ARG_BUFFER(f->renderer.background),
                       GSCL_ARG(settings), GSCL_ARG_BUFFER(f->density_total), GSCL_ARG_BUFFER(f->error));
}

static gscl_result seed_splats(gscl_fit *f, size_t count, uint64_t *random) {
    gscl_placement_settings settings = gscl_placement_begin(f, count);
    settings.density_scale = 1.0f;
    settings.has_background = f->flat.pixels > 0;
    settings.tolerance = gscl_image_tunables.colour_tolerance;
    settings.axis = gscl_fit_tunables.seed_axis * settings.scale;
    settings.most_distance = (float)(settings.width + settings.height);
    GSCL_TRY(seed_density(f, settings));
    return gscl_placement_append(f, settings, random);
}

static gscl_result add_by_error(gscl_fit *f, size_t count, uint64_t *random) {
    const struct gscl_fit_tunables *t = &gscl_fit_tunables;
    gscl_placement_settings settings = gscl_placement_begin(f, count);
    const float area = non_flat_area(f), distance = sqrtf(area / (float)((size_t)f->renderer.count + count));
    const float mean_distance = sqrtf(area / (float)count); /* of the new splats */
    const int32_t radius = (int32_t)(t->error_radius * distance) + 1;
    settings.density_scale = 1.0f / ((2.0f * (float)radius + 1.0f) * (2.0f * (float)radius + 1.0f));
    settings.axis = t->new_axis * distance * settings.scale / mean_distance;
    settings.least_distance = mean_distance;
    settings.most_distance = t->max_spread * mean_distance;
    settings.opacity = t->new_opacity;
    GSCL_TRY(gscl_fit_begin_error(f));
    GSCL_TRY(gscl_fit_sum_error(f));
    GSCL_TRY(launch_box_sum(f, settings, radius, 0));
    return gscl_placement_append(f, settings, random);
}

/* ---- Clone and split ---- */

/* A splat and the size of the gradient of its position. */
typedef struct ranked_splat {
    float gradient;
    size_t splat;
} ranked_splat;

/* Order: from the largest gradient to the smallest. */
static int compare_ranks(const void *a, const void *b) {
    const ranked_splat *p = a, *q = b;
    if (p->gradient != q->gradient)
        return p->gradient < q->gradient ? 1 : -1;
    return p->splat < q->splat ? -1 : p->splat > q->splat;
}

static float log_size(const float *p) {
    return 0.5f * (p[GSCL_LOG_S1] + p[GSCL_LOG_S2]);
}

/* Copies a splat and moves the copy against the gradient by half its size; `moment`: first moments, in the splat's
 * frame (cl/update.cl). */
static void clone_splat(const float *from, const float *moment, float *to) {
    float norm = (float)gscl_hypot(moment[GSCL_X], moment[GSCL_Y]), step = 0.5f * (float)gscl_exp(log_size(from));
    float c = (float)gscl_cos(from[GSCL_THETA]), s = (float)gscl_sin(from[GSCL_THETA]);
    memcpy(to, from, GSCL_PARAMS * sizeof(float));
    if (!(norm > 0))
        return;
    to[GSCL_X] -= step * (c * moment[GSCL_X] - s * moment[GSCL_Y]) / norm;
    to[GSCL_Y] -= step * (s * moment[GSCL_X] + c * moment[GSCL_Y]) / norm;
}

/* Replaces a splat by two smaller ones, which lie apart along its longer axis. */
static void split_splat(float *from, float *to) {
    bool first = from[GSCL_LOG_S1] >= from[GSCL_LOG_S2];
    float length = 0.5f * (float)gscl_exp(from[first ? GSCL_LOG_S1 : GSCL_LOG_S2]),
          angle = from[GSCL_THETA] + (first ? 0 : 1.57079633f);
    float x = length * (float)gscl_cos(angle), y = length * (float)gscl_sin(angle);
    float shrinking = (float)gscl_ln(SPLIT_FACTOR);
    from[GSCL_LOG_S1] -= shrinking;
    from[GSCL_LOG_S2] -= shrinking;
    memcpy(to, from, GSCL_PARAMS * sizeof(float));
    to[GSCL_X] += x;
    to[GSCL_Y] += y;
    from[GSCL_X] -= x;
    from[GSCL_Y] -= y;
}

/* Clones or splits the `count` splats with the largest gradients.  `params`: the fit's splats, with room for `count`
 * more behind; `moments`: their first and second moments; `ranks`: scratch. */
static gscl_result densify_splats(gscl_fit *f, float *params, const float *moments, ranked_splat *ranks, size_t count) {
    size_t have = (size_t)f->renderer.count;
    const float *second = moments + have * GSCL_PARAMS;
    double mean_size = 0;
    for (size_t i = 0; i < have; i++) {
        ranks[i] = (ranked_splat){second[i * GSCL_PARAMS + GSCL_X] + second[i * GSCL_PARAMS + GSCL_Y], i};
        mean_size += log_size(params + i * GSCL_PARAMS) / (double)have;
    }
    qsort(ranks, have, sizeof *ranks, compare_ranks);
    for (size_t i = 0; i < count; i++) {
        float *from = params + ranks[i].splat * GSCL_PARAMS, *to = params + (have + i) * GSCL_PARAMS;
        if (log_size(from) < (float)mean_size)
            clone_splat(from, moments + ranks[i].splat * GSCL_PARAMS, to);
        else
            split_splat(from, to);
    }
    GSCL_TRY(gscl_buffer_write(f->context, &f->renderer.params, 0, params, have * GSCL_PARAMS * sizeof(float)));
    return gscl_fit_append(f, params + have * GSCL_PARAMS, count);
}

gscl_result gscl_density_densify(gscl_fit *f, size_t count) {
    size_t have = (size_t)f->renderer.count, row = GSCL_PARAMS * sizeof(float);
    if (count > have)
        count = have;
    if (count == 0)
        return GSCL_OK;
    float *params = malloc((have + count) * row), *moments = malloc(2 * have * row);
    ranked_splat *ranks = malloc(have * sizeof *ranks);
    gscl_result result = params && moments && ranks ? GSCL_OK : gscl_fail_memory(f->context);
    if (result == GSCL_OK)
        result = gscl_fit_read(f, params);
    if (result == GSCL_OK)
        result = gscl_buffer_read(f->context, &f->first_moment, 0, moments, have * row);
    if (result == GSCL_OK)
        result = gscl_buffer_read(f->context, &f->second_moment, 0, moments + have * GSCL_PARAMS, have * row);
    if (result == GSCL_OK)
        result = densify_splats(f, params, moments, ranks, count);
    free(params);
    free(moments);
    free(ranks);
    return result;
}

/* ---- Entry points ---- */

typedef gscl_result placer(gscl_fit *, size_t, uint64_t *);

static gscl_result place_in_stage(placer *place_splats, gscl_fit *f, size_t count, uint64_t *random) {
    if (count == 0)
        return GSCL_OK;
    const gscl_stage_id before = gscl_short_stage(f->context, GSCL_STAGE_DENSITY);
    const gscl_result result = place_splats(f, count, random);
    gscl_short_stage(f->context, before);
    return result;
}

gscl_result gscl_density_seed(gscl_fit *f, size_t count, uint64_t *random) {
    return place_in_stage(seed_splats, f, count, random);
}

gscl_result gscl_density_grow(gscl_fit *f, size_t count, uint64_t *random) {
    return place_in_stage(add_by_error, f, count, random);
}
