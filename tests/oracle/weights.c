#include <math.h>
#include <stdlib.h>

#include "fit_oracle.h"

#define TAPS 11

typedef struct {
    const double *plane;
    int width, height;
} image;

static double tap(int i) {
    double sum = 0.0;
    for (int k = 0; k < TAPS; k++)
        sum += exp(-(k - 5) * (k - 5) / 4.5);
    return exp(-(i - 5) * (i - 5) / 4.5) / sum;
}

/* The weight, contrast gain and mean of a window of the target, and of the rendering if there is one. */
typedef struct {
    double weight, gain, mean;
} window_result;

static window_result evaluate_window(const image *target, const image *rendering, int x, int y) {
    double mean = 0.0, square = 0.0, other_mean = 0.0, other_square = 0.0, product = 0.0;
    for (int v = 0; v < TAPS; v++)
        for (int u = 0; u < TAPS; u++) {
            const int at = (y + v) * target->width + x + u;
            const double share = tap(u) * tap(v), value = target->plane[at],
                         other = rendering ? rendering->plane[at] : 0.0;
            mean += share * value;
            square += share * value * value;
            other_mean += share * other;
            other_square += share * other * other;
            product += share * value * other;
        }
    const double variances = square - mean * mean + other_square - other_mean * other_mean + 9e-4;
    const double similarity = (2.0 * (product - mean * other_mean) + 9e-4) / variances;
    return (window_result){9e-4 / variances, fmin(1.0 / fmax(similarity, 0.1) - 1.0, 0.5), mean};
}

/* Weighted mean over the windows that cover a pixel; `values` has one for each window. */
static double mean_around(const double *values, const image *m, int x, int y) {
    const int columns = m->width - TAPS + 1, rows = m->height - TAPS + 1;
    double sum = 0.0, cover = 0.0;
    for (int v = 0; v < TAPS; v++)
        for (int u = 0; u < TAPS; u++) {
            const int left = x - u, top = y - v;
            if (left < 0 || top < 0 || left >= columns || top >= rows)
                continue;
            sum += tap(u) * tap(v) * values[top * columns + left];
            cover += tap(u) * tap(v);
        }
    return sum / cover;
}

/* Adds the mean weight of one channel around each pixel. */
static void add_weights(const image *m, double *sums) {
    const int columns = m->width - TAPS + 1, rows = m->height - TAPS + 1;
    double *window_weights = malloc(sizeof *window_weights * (size_t)columns * (size_t)rows);
    if (!window_weights)
        abort();
    for (int i = 0; i < columns * rows; i++)
        window_weights[i] = evaluate_window(m, NULL, i % columns, i / columns).weight;
    for (int i = 0; i < m->width * m->height; i++)
        sums[i] += mean_around(window_weights, m, i % m->width, i / m->width);
    free(window_weights);
}

static int smaller(int a, int b) {
    return a < b ? a : b;
}

static void halve(double *planes, int channels, int *width, int *height) {
    const int w = *width, h = *height, half_w = (w + 1) / 2, half_h = (h + 1) / 2;
    for (int k = 0; k < channels; k++)
        for (int i = 0; i < half_w * half_h; i++) {
            const double *p = planes + k * w * h;
            const int x = 2 * (i % half_w), y = 2 * (i / half_w), x1 = smaller(x + 1, w - 1),
                      y1 = smaller(y + 1, h - 1);
            planes[k * half_w * half_h + i] = (p[y * w + x] + p[y * w + x1] + p[y1 * w + x] + p[y1 * w + x1]) / 4.0;
        }
    *width = half_w;
    *height = half_h;
}

void oracle_ssim_weights(double *planes, int channels, int width, int height, int last_level, double *weights) {
    static const double exponents[3] = {0.2856, 0.3001, 0.2363};
    int w = width, h = height, level = 0;
    double *sums = malloc(sizeof *sums * (size_t)width * (size_t)height);
    if (!sums)
        abort();
    for (int i = 0; i < width * height; i++)
        weights[i] = 0.0;
    for (int scale = 1; scale <= 3; scale++) {
        for (; level < smaller(scale, last_level); level++)
            halve(planes, channels, &w, &h);
        for (int i = 0; i < w * h; i++)
            sums[i] = 0.0;
        for (int k = 0; k < channels; k++)
            add_weights(&(image){planes + k * w * h, w, h}, sums);
        for (int i = 0; i < width * height; i++)
            weights[i] += exponents[scale - 1] * pow(sums[(i / width >> level) * w + (i % width >> level)], 0.8);
    }
    free(sums);
}

/* One channel at half size: adds to the weights, and writes contrast gain and mean at each pixel. */
static void adapt_channel(const image *target, const image *rendering, double *weights, double *gains, double *means) {
    const int columns = target->width - TAPS + 1, windows = columns * (target->height - TAPS + 1);
    double *maps = malloc(3 * sizeof *maps * (size_t)windows);
    if (!maps)
        abort();
    for (int i = 0; i < windows; i++) {
        const window_result r = evaluate_window(target, rendering, i % columns, i / columns);
        maps[i] = r.weight;
        maps[windows + i] = r.gain;
        maps[2 * windows + i] = r.mean;
    }
    for (int i = 0; i < target->width * target->height; i++) {
        const int x = i % target->width, y = i / target->width;
        weights[i] += mean_around(maps, target, x, y);
        gains[i] = mean_around(maps + windows, target, x, y);
        means[i] = mean_around(maps + 2 * windows, target, x, y);
    }
    free(maps);
}

void oracle_ssim_adapt(double *planes, double *rendering, int channels, int width, int height, int last_level,
                       double *adapted) {
    const int plane = width * height;
    int w = width, h = height, w2 = width, h2 = height;
    double *weights = adapted + channels * plane, *work = calloc(3 * sizeof *work, (size_t)plane);
    double *half_weights = work, *gains = work + plane, *means = work + 2 * plane;
    if (!work)
        abort();
    for (int i = 0; i < channels * plane; i++)
        adapted[i] = planes[i];
    oracle_ssim_weights(planes, channels, width, height, last_level, weights);
    for (int i = 0; i < channels * plane; i++)
        planes[i] = adapted[i];
    halve(planes, channels, &w, &h);
    halve(rendering, channels, &w2, &h2);
    for (int k = 0; k < channels; k++) {
        adapt_channel(&(image){planes + k * w * h, w, h}, &(image){rendering + k * w * h, w, h}, half_weights, gains,
                      means);
        for (int i = 0; i < plane; i++) {
            const int at = i / width / 2 * w + i % width / 2;
            adapted[k * plane + i] += gains[at] * (adapted[k * plane + i] - means[at]);
        }
    }
    for (int i = 0; i < plane; i++)
        weights[i] += half_weights[i / width / 2 * w + i % width / 2];
    free(work);
}
