#include "fit/placement.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "fit/random.h"
#include "fit/tunables.h"

static const struct gscl_fit_tunables *const tunables = &gscl_fit_tunables;

void gscl_placement_free(gscl_placement *p) {
    free(p->target);
    free(p->density);
    free(p->near_edges);
    free(p->sums);
}

gscl_result gscl_placement_create(gscl_placement *p, gscl_fit *f) {
    memset(p, 0, sizeof *p);
    p->width = (int)gscl_fit_level_width(f);
    p->height = (int)gscl_fit_level_height(f);
    p->channels = f->renderer.channels;
    p->rotated = f->renderer.options.shape == GSCL_SHAPE_ROTATED;
    p->scale = ldexpf(1.0f, f->level);
    size_t pixels = (size_t)p->width * (size_t)p->height;
    p->target = malloc(pixels * (size_t)p->channels * sizeof(float));
    p->density = malloc(pixels * sizeof(float));
    p->near_edges = f->flat.pixels > 0 ? malloc(pixels * sizeof(float)) : NULL;
    p->sums = malloc(pixels * sizeof(double));
    if (!p->target || !p->density || (f->flat.pixels > 0 && !p->near_edges) || !p->sums)
        return gscl_fail_memory(f->context);
    return gscl_fit_target(f, p->target);
}

float gscl_placement_area(const gscl_placement *p, const gscl_fit *f) {
    return fmaxf(1.0f - (float)f->flat.pixels, tunables->min_non_flat_pixels) * (float)p->width * (float)p->height;
}

/* ---- Sampling ---- */

void gscl_placement_accumulate(gscl_placement *p, size_t count) {
    double total = 0, *sum = p->sums;
    p->count = count;
    p->strip = (int)sqrt((double)p->width * p->height / (double)count) + 1;
    for (int top = 0; top < p->height; top += p->strip) {
        int bottom = top + p->strip < p->height ? top + p->strip : p->height;
        bool backwards = top / p->strip % 2;
        for (int i = 0; i < p->width; i++) {
            int x = backwards ? p->width - 1 - i : i;
            for (int y = top; y < bottom; y++)
                *sum++ = total += p->density[(size_t)y * (size_t)p->width + (size_t)x];
        }
    }
}

/* Pixel at a place of the order of strips. */
static size_t pixel_of_place(const gscl_placement *p, size_t place) {
    size_t width = (size_t)p->width, strip = (size_t)p->strip, number = place / (width * strip);
    size_t top = number * strip, in_strip = place - top * width;
    size_t rows = (size_t)p->height - top < strip ? (size_t)p->height - top : strip, column = in_strip / rows;
    return (top + in_strip % rows) * width + (number % 2 ? width - 1 - column : column);
}

static double total_density(const gscl_placement *p) {
    return p->sums[(size_t)p->width * (size_t)p->height - 1];
}

size_t gscl_placement_sample(const gscl_placement *p, size_t index, uint64_t *random) {
    double value = ((double)index + gscl_random_unit(random)) / (double)p->count * total_density(p);
    size_t low = 0, high = (size_t)p->width * (size_t)p->height - 1;
    while (low < high) {
        size_t mid = low + (high - low) / 2;
        if (p->sums[mid] < value)
            low = mid + 1;
        else
            high = mid;
    }
    return pixel_of_place(p, low);
}

float gscl_placement_distance(const gscl_placement *p, size_t pixel) {
    double share = p->density[pixel] / total_density(p);
    return share > 0 ? (float)(1.0 / sqrt(share * (double)p->count)) : (float)hypot(p->width, p->height);
}

/* ---- Splats ---- */

/* The structure tensor around a pixel: sums of the products of the derivatives in x and y, over all channels. */
typedef struct tensor {
    float xx, yy, xy;
} tensor;

static tensor tensor_around(const gscl_placement *p, size_t pixel, int radius) {
    size_t width = (size_t)p->width, pixels = width * (size_t)p->height;
    int x0 = (int)(pixel % width), y0 = (int)(pixel / width);
    int left = x0 - radius > 1 ? x0 - radius : 1, right = x0 + radius < p->width - 2 ? x0 + radius : p->width - 2;
    int top = y0 - radius > 1 ? y0 - radius : 1, bottom = y0 + radius < p->height - 2 ? y0 + radius : p->height - 2;
    tensor sum = {0, 0, 0};
    for (int k = 0; k < p->channels; k++)
        for (int y = top; y <= bottom; y++)
            for (int x = left; x <= right; x++) {
                const float *t = p->target + (size_t)k * pixels + (size_t)y * width + (size_t)x;
                float by_x = t[1] - t[-1], by_y = t[width] - *(t - width);
                sum.xx += by_x * by_x;
                sum.yy += by_y * by_y;
                sum.xy += by_x * by_y;
            }
    return sum;
}

/* Turns a circular splat along the edge below it and stretches it, by the coherence of the structure tensor: 1 at a
 * straight edge, 0 where no direction prevails. */
static void follow_edge(const gscl_placement *p, size_t pixel, float sigma, float *params) {
    int radius = (int)fminf(fmaxf(sigma / p->scale, 1.0f), (float)tunables->max_edge_radius);
    tensor t = tensor_around(p, pixel, radius);
    float coherence = hypotf(t.xx - t.yy, 2.0f * t.xy) / (t.xx + t.yy + tunables->min_edge);
    float stretch = tunables->edge_stretch * coherence;
    params[GSCL_THETA] = 0.5f * atan2f(2.0f * t.xy, t.xx - t.yy) + 1.57079633f;
    params[GSCL_LOG_S1] += stretch;
    params[GSCL_LOG_S2] = fmaxf(params[GSCL_LOG_S2] - stretch, logf(tunables->min_axis));
}

void gscl_placement_splat(const gscl_placement *p, size_t pixel, float sigma, float opacity, uint64_t *random,
                          float *params) {
    size_t pixels = (size_t)p->width * (size_t)p->height;
    sigma = fmaxf(sigma, tunables->min_axis);
    params[GSCL_X] = ((float)(pixel % (size_t)p->width) + gscl_random_unit(random)) * p->scale;
    params[GSCL_Y] = ((float)(pixel / (size_t)p->width) + gscl_random_unit(random)) * p->scale;
    params[GSCL_LOG_S1] = params[GSCL_LOG_S2] = logf(sigma);
    params[GSCL_THETA] = 0.0f;
    params[GSCL_OPACITY] = opacity;
    for (int k = 0; k < p->channels; k++)
        params[GSCL_COLOUR + k] = p->target[(size_t)k * pixels + pixel];
    if (p->rotated)
        follow_edge(p, pixel, sigma, params);
}
