#include "fit/placement.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "fit/random.h"
#include "fit/tunables.h"

static const struct gscl_fit_tunables *const tunables = &gscl_fit_tunables;

/* ---- Strips ---- */

/* Columns of all strips. */
static size_t columns(const gscl_placement *p) {
    return (size_t)p->width * (size_t)((p->height + p->strip - 1) / p->strip);
}

/* Row below the strip that begins at row `top`. */
static int strip_end(const gscl_placement *p, int top) {
    return top + p->strip < p->height ? top + p->strip : p->height;
}

/* Each second strip is walked backwards. */
static int column_x(const gscl_placement *p, int top, int column) {
    return top / p->strip % 2 ? p->width - 1 - column : column;
}

/* ---- Maps ---- */

void gscl_placement_free(gscl_placement *p) {
    free(p->band);
    free(p->density);
    free(p->scratch);
    free(p->sums);
}

/* Rows beyond a strip that edges at its splats need. */
static int margin(void) {
    return tunables->max_edge_radius + 1;
}

static int target_rows(const gscl_placement *p, bool all) {
    const int rows = tunables->target_band_pixels / p->width, least = p->strip + 2 * margin();
    return all || rows > p->height || least > p->height ? p->height : rows > least ? rows : least;
}

gscl_result gscl_placement_create(gscl_placement *p, gscl_fit *f, size_t count, bool all) {
    memset(p, 0, sizeof *p);
    p->width = (int)gscl_fit_level_width(f);
    p->height = (int)gscl_fit_level_height(f);
    p->channels = f->renderer.channels;
    p->rotated = f->renderer.options.shape == GSCL_SHAPE_ROTATED;
    p->scale = ldexpf(1.0f, f->level);
    p->count = count;
    p->strip = (int)sqrt((double)p->width * p->height / (double)count) + 1;
    p->rows = target_rows(p, all);
    p->top = -p->rows;
    const size_t width = (size_t)p->width, height = (size_t)p->height;
    p->density = malloc(width * height * sizeof(float));
    p->sums = malloc(columns(p) * sizeof(double));
    p->scratch = malloc((width > height ? width : height) * sizeof(double));
    const bool has_band = width * height > (size_t)tunables->target_band_pixels;
    if (has_band)
        p->target = p->band = malloc(width * (size_t)p->rows * (size_t)p->channels * sizeof(float));
    return p->density && p->sums && p->scratch && (p->band || !has_band) ? GSCL_OK : gscl_fail_memory(f->context);
}

gscl_result gscl_placement_read_target(gscl_placement *p, gscl_fit *f, int y) {
    const int strip_top = y / p->strip * p->strip;
    const int first = strip_top > margin() ? strip_top - margin() : 0;
    const int end = strip_end(p, strip_top) + margin() < p->height ? strip_end(p, strip_top) + margin() : p->height;
    if (first >= p->top && end <= p->top + p->rows)
        return GSCL_OK;
    p->top = first < p->height - p->rows ? first : p->height - p->rows;
    if (!p->band)
        return gscl_fit_target_planes(f, &p->target);
    const size_t width = (size_t)p->width, band = width * (size_t)p->rows;
    for (size_t k = 0; k < (size_t)p->channels; k++)
        GSCL_TRY(
            gscl_fit_target_samples(f, width * (k * (size_t)p->height + (size_t)p->top), band, p->band + k * band));
    return GSCL_OK;
}

float gscl_placement_area(const gscl_placement *p, const gscl_fit *f) {
    return fmaxf(1.0f - (float)f->flat.pixels, tunables->min_non_flat_pixels) * (float)p->width * (float)p->height;
}

/* ---- Sampling ---- */

void gscl_placement_accumulate(gscl_placement *p) {
    double total = 0, *sum = p->sums;
    for (int top = 0; top < p->height; top += p->strip)
        for (int column = 0; column < p->width; column++) {
            const size_t x = (size_t)column_x(p, top, column);
            for (int y = top; y < strip_end(p, top); y++)
                total += p->density[(size_t)y * (size_t)p->width + x];
            *sum++ = total;
        }
}

static double total_density(const gscl_placement *p) {
    return p->sums[columns(p) - 1];
}

/* The column of the walk in which the cumulative density passes `value`. */
static size_t find_column(const gscl_placement *p, double value) {
    size_t low = 0, high = columns(p) - 1;
    while (low < high) {
        size_t mid = low + (high - low) / 2;
        if (p->sums[mid] < value)
            low = mid + 1;
        else
            high = mid;
    }
    return low;
}

size_t gscl_placement_sample(const gscl_placement *p, size_t index, uint64_t *random) {
    const double value = ((double)index + gscl_random_unit(random)) / (double)p->count * total_density(p);
    const size_t column = find_column(p, value), width = (size_t)p->width;
    const int top = (int)(column / width) * p->strip;
    const size_t x = (size_t)column_x(p, top, (int)(column % width));
    double sum = column > 0 ? p->sums[column - 1] : 0;
    int y = top;
    while (y < strip_end(p, top) - 1 && (sum += p->density[(size_t)y * width + x]) < value)
        y++;
    return (size_t)y * width + x;
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
    size_t width = (size_t)p->width, plane = width * (size_t)p->rows;
    int x0 = (int)(pixel % width), y0 = (int)(pixel / width);
    int left = x0 - radius > 1 ? x0 - radius : 1, right = x0 + radius < p->width - 2 ? x0 + radius : p->width - 2;
    int top = y0 - radius > 1 ? y0 - radius : 1, bottom = y0 + radius < p->height - 2 ? y0 + radius : p->height - 2;
    tensor sum = {0, 0, 0};
    for (int k = 0; k < p->channels; k++)
        for (int y = top; y <= bottom; y++)
            for (int x = left; x <= right; x++) {
                const float *t = p->target + (size_t)k * plane + (size_t)(y - p->top) * width + (size_t)x;
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
    size_t plane = (size_t)p->width * (size_t)p->rows, in_rows = pixel - (size_t)p->width * (size_t)p->top;
    sigma = fmaxf(sigma, tunables->min_axis);
    params[GSCL_X] = ((float)(pixel % (size_t)p->width) + gscl_random_unit(random)) * p->scale;
    params[GSCL_Y] = ((float)(pixel / (size_t)p->width) + gscl_random_unit(random)) * p->scale;
    params[GSCL_LOG_S1] = params[GSCL_LOG_S2] = logf(sigma);
    params[GSCL_THETA] = 0.0f;
    params[GSCL_OPACITY] = opacity;
    for (int k = 0; k < p->channels; k++)
        params[GSCL_COLOUR + k] = p->target[(size_t)k * plane + in_rows];
    if (p->rotated)
        follow_edge(p, pixel, sigma, params);
}
