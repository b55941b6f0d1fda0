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

/* C2 / (variance + C2) of the window that begins at (x, y). */
static double smoothness(const image *m, int x, int y) {
    double mean = 0.0, square = 0.0;
    for (int v = 0; v < TAPS; v++)
        for (int u = 0; u < TAPS; u++) {
            const double value = m->plane[(y + v) * m->width + x + u];
            mean += tap(u) * tap(v) * value;
            square += tap(u) * tap(v) * value * value;
        }
    return 9e-4 / (square - mean * mean + 9e-4);
}

/* Mean over the windows that see a pixel; `smooth` has a value for each window. */
static double mean_around(const double *smooth, const image *m, int x, int y) {
    const int columns = m->width - TAPS + 1, rows = m->height - TAPS + 1;
    double sum = 0.0, seen = 0.0;
    for (int v = 0; v < TAPS; v++)
        for (int u = 0; u < TAPS; u++) {
            const int left = x - u, top = y - v;
            if (left < 0 || top < 0 || left >= columns || top >= rows)
                continue;
            sum += tap(u) * tap(v) * smooth[top * columns + left];
            seen += tap(u) * tap(v);
        }
    return sum / seen;
}

/* Adds the mean smoothness of one channel around each pixel. */
static void add_smoothness(const image *m, double *sums) {
    const int columns = m->width - TAPS + 1, rows = m->height - TAPS + 1;
    double *smooth = malloc(sizeof *smooth * (size_t)columns * (size_t)rows);
    if (!smooth)
        abort();
    for (int i = 0; i < columns * rows; i++)
        smooth[i] = smoothness(m, i % columns, i / columns);
    for (int i = 0; i < m->width * m->height; i++)
        sums[i] += mean_around(smooth, m, i % m->width, i / m->width);
    free(smooth);
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
    static const double shares[3] = {0.2856, 0.3001, 0.2363};
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
            add_smoothness(&(image){planes + k * w * h, w, h}, sums);
        for (int i = 0; i < width * height; i++)
            weights[i] += shares[scale - 1] * pow(sums[(i / width >> level) * w + (i % width >> level)], 0.8);
    }
    free(sums);
}
