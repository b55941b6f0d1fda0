#include "fit/density.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "fit/placement.h"
#include "fit/tunables.h"
#include "image/box_sum.h"
#include "image/flat_background.h"
#include "runtime/timing.h"

#define SPLIT_FACTOR 1.6f /* the paper's released code */

/* Writes the magnitude of the image's gradient into the density: central differences, all channels. */
static void gradient_magnitude(gscl_placement *p) {
    size_t pixels = (size_t)p->width * (size_t)p->height;
    for (int y = 0; y < p->height; y++)
        for (int x = 0; x < p->width; x++) {
            int left = x ? x - 1 : x, right = x < p->width - 1 ? x + 1 : x;
            int up = y ? y - 1 : y, down = y < p->height - 1 ? y + 1 : y;
            float sum = 0;
            for (int k = 0; k < p->channels; k++) {
                const float *t = p->target + (size_t)k * pixels;
                float gx = t[y * p->width + right] - t[y * p->width + left];
                float gy = t[down * p->width + x] - t[up * p->width + x];
                sum += gx * gx + gy * gy;
            }
            p->density[y * p->width + x] = sqrtf(sum);
        }
}

/* Adds to the density of the pixels that need splats, which those of a flat background away from edges do not: there
 * they would cost time without any gain. */
static gscl_result add_outside_background(const gscl_fit *f, gscl_placement *p, float density) {
    size_t pixels = (size_t)p->width * (size_t)p->height;
    float *near_edges = malloc(pixels * sizeof *near_edges);
    if (!near_edges)
        return gscl_fail_memory(f->context);
    memcpy(near_edges, p->density, pixels * sizeof *near_edges);
    float distance = sqrtf(gscl_placement_area(p, f) / (float)p->count);
    int radius = (int)(gscl_fit_tunables.background_distance * distance) + 1;
    gscl_box_sum(near_edges, p->width, p->height, radius, p->scratch);
    for (size_t i = 0; i < pixels; i++)
        if (near_edges[i] > 0 || !gscl_matches_background(p->target, pixels, p->channels, f->background, i))
            p->density[i] += density;
    free(near_edges);
    return GSCL_OK;
}

/* Makes the density of the first splats from the edges in p->density: half of them follow the edges, half are spread
 * evenly. */
static gscl_result seed_density(const gscl_fit *f, gscl_placement *p) {
    size_t pixels = (size_t)p->width * (size_t)p->height;
    double total = 0;
    for (size_t i = 0; i < pixels; i++)
        total += p->density[i];
    for (size_t i = 0; i < pixels; i++)
        p->density[i] = total > 0 ? 0.5f * (float)(p->density[i] / total) : 0.5f / (float)pixels;
    if (f->flat.pixels > 0)
        return add_outside_background(f, p, 0.5f / (float)pixels);
    for (size_t i = 0; i < pixels; i++)
        p->density[i] += 0.5f / (float)pixels;
    return GSCL_OK;
}

static gscl_result seed_splats(gscl_fit *f, gscl_placement *p, size_t count, uint64_t *random, float *params) {
    GSCL_TRY(gscl_placement_create(p, f, count, true));
    GSCL_TRY(gscl_placement_read_target(p, f, 0));
    const gscl_stage_id before = gscl_stage(f->context, GSCL_STAGE_DENSITY);
    gradient_magnitude(p);
    GSCL_TRY(seed_density(f, p));
    gscl_placement_accumulate(p);
    for (size_t i = 0; i < count; i++) {
        size_t pixel = gscl_placement_sample(p, i, random);
        float sigma = gscl_fit_tunables.seed_axis * p->scale * gscl_placement_distance(p, pixel);
        gscl_placement_splat(p, pixel, sigma, 0.0f, random, params + i * GSCL_PARAMS);
    }
    gscl_stage(f->context, before);
    return gscl_fit_append(f, params, count);
}

static gscl_result add_by_error(gscl_fit *f, gscl_placement *p, size_t count, uint64_t *random, float *params) {
    GSCL_TRY(gscl_placement_create(p, f, count, false));
    GSCL_TRY(gscl_fit_error(f, p->density));
    const gscl_stage_id before = gscl_stage(f->context, GSCL_STAGE_DENSITY); /* the device has nothing to do now */
    const struct gscl_fit_tunables *t = &gscl_fit_tunables;
    float area = gscl_placement_area(p, f), distance = sqrtf(area / (float)((size_t)f->renderer.count + count));
    float mean_distance = sqrtf(area / (float)count); /* of the new splats */
    gscl_box_sum(p->density, p->width, p->height, (int)(t->error_radius * distance) + 1, p->scratch);
    gscl_placement_accumulate(p);
    for (size_t i = 0; i < count; i++) {
        size_t pixel = gscl_placement_sample(p, i, random);
        float spread = gscl_placement_distance(p, pixel) / mean_distance;
        float sigma = t->new_axis * distance * p->scale * fminf(fmaxf(spread, 1.0f), t->max_spread);
        GSCL_TRY(gscl_placement_read_target(p, f, (int)(pixel / (size_t)p->width)));
        gscl_placement_splat(p, pixel, sigma, t->new_opacity, random, params + i * GSCL_PARAMS);
    }
    gscl_stage(f->context, before);
    return gscl_fit_append(f, params, count);
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
    float norm = hypotf(moment[GSCL_X], moment[GSCL_Y]), step = 0.5f * expf(log_size(from));
    float c = cosf(from[GSCL_THETA]), s = sinf(from[GSCL_THETA]);
    memcpy(to, from, GSCL_PARAMS * sizeof(float));
    if (!(norm > 0))
        return;
    to[GSCL_X] -= step * (c * moment[GSCL_X] - s * moment[GSCL_Y]) / norm;
    to[GSCL_Y] -= step * (s * moment[GSCL_X] + c * moment[GSCL_Y]) / norm;
}

/* Replaces a splat by two smaller ones, which lie apart along its longer axis. */
static void split_splat(float *from, float *to) {
    bool first = from[GSCL_LOG_S1] >= from[GSCL_LOG_S2];
    float length = 0.5f * expf(from[first ? GSCL_LOG_S1 : GSCL_LOG_S2]),
          angle = from[GSCL_THETA] + (first ? 0 : 1.57079633f);
    from[GSCL_LOG_S1] -= logf(SPLIT_FACTOR);
    from[GSCL_LOG_S2] -= logf(SPLIT_FACTOR);
    memcpy(to, from, GSCL_PARAMS * sizeof(float));
    to[GSCL_X] += length * cosf(angle);
    to[GSCL_Y] += length * sinf(angle);
    from[GSCL_X] -= length * cosf(angle);
    from[GSCL_Y] -= length * sinf(angle);
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

typedef gscl_result placer(gscl_fit *, gscl_placement *, size_t, uint64_t *, float *);

static gscl_result with_placement(placer *place_splats, gscl_fit *f, size_t count, uint64_t *random) {
    if (count == 0)
        return GSCL_OK;
    gscl_placement p = {0};
    float *params = calloc(count, GSCL_PARAMS * sizeof(float));
    gscl_result result = params ? place_splats(f, &p, count, random, params) : gscl_fail_memory(f->context);
    gscl_placement_free(&p);
    free(params);
    return result;
}

gscl_result gscl_density_seed(gscl_fit *f, size_t count, uint64_t *random) {
    return with_placement(seed_splats, f, count, random);
}

gscl_result gscl_density_grow(gscl_fit *f, size_t count, uint64_t *random) {
    return with_placement(add_by_error, f, count, random);
}
