#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "visual.h"

#define TAPS 9
#define SCALES 5

typedef struct {
    int width, height;
    double *plane;
} picture;

static picture picture_make(int width, int height) {
    return (picture){.width = width, .height = height, .plane = calloc((size_t)(width * height), sizeof(double))};
}

static double linear_of(double s) {
    s = fmin(fmax(s, 0.0), 1.0);
    return s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4);
}

static picture luminance_of(const double *planes, int colours, int width, int height) {
    static const double shares[3] = {0.265, 0.657, 0.078};
    picture p = picture_make(width, height);
    for (int i = 0; i < width * height; i++)
        for (int k = 0; k < colours; k++)
            p.plane[i] += (colours == 3 ? shares[k] : 1) * linear_of(planes[k * width * height + i]);
    return p;
}

static picture half_size(const picture *from) {
    picture p = picture_make((from->width + 1) / 2, (from->height + 1) / 2);
    for (int i = 0; i < 4 * p.width * p.height; i++) {
        const int to = i / 4, x = 2 * (to % p.width) + i % 2, y = 2 * (to / p.width) + i / 2 % 2;
        const int at =
            (y < from->height ? y : from->height - 1) * from->width + (x < from->width ? x : from->width - 1);
        p.plane[to] += 0.25 * from->plane[at];
    }
    return p;
}

static picture luma_of(const picture *luminance) {
    const double bias = 0.0037930732552754493;
    picture p = picture_make(luminance->width, luminance->height);
    for (int i = 0; i < p.width * p.height; i++)
        p.plane[i] = cbrt(luminance->plane[i] + bias) - cbrt(bias) + 0.01;
    return p;
}

/* The blur of a product of two planes, with zeros beyond the border. */
static double *blur(const double *a, const double *b, int width, int height) {
    static const double window[TAPS] = {0.0094143678096537337, 0.036011114658364391, 0.10933537277746035,
                                        0.21292859201042227,   0.26462110548819859,  0.21292859201042227,
                                        0.10933537277746035,   0.036011114658364391, 0.0094143678096537337};
    double *rows = calloc((size_t)(width * height), sizeof *rows),
           *sums = calloc((size_t)(width * height), sizeof *sums);
    for (int i = 0; i < width * height; i++)
        for (int t = 0; t < TAPS; t++) {
            const int x = i % width + t - 4;
            if (x >= 0 && x < width)
                rows[i] += window[t] * a[i + t - 4] * (b ? b[i + t - 4] : 1.0);
        }
    for (int i = 0; i < width * height; i++)
        for (int t = 0; t < TAPS; t++) {
            const int y = i / width + t - 4;
            if (y >= 0 && y < height)
                sums[i] += window[t] * rows[i + (t - 4) * width];
        }
    free(rows);
    return sums;
}

/* Weight of the mean and of the 4-norm of each map. */
static double sum_of_maps(const double *x, const double *y, int width, int height, const double weights[6],
                          double peaks) {
    double *mean_x = blur(x, NULL, width, height), *mean_y = blur(y, NULL, width, height);
    double *xx = blur(x, x, width, height), *yy = blur(y, y, width, height), *xy = blur(x, y, width, height);
    double sums[6] = {0}, sixth_powers = 0, result = 0;
    for (int i = 0; i < width * height; i++) {
        const double m = mean_x[i], n = mean_y[i];
        const double structure = (2 * (xy[i] - m * n) + 9e-4) / ((xx[i] - m * m) + (yy[i] - n * n) + 9e-4);
        const double e = (1 + fabs(y[i] - n)) / (1 + fabs(x[i] - m)) - 1;
        sixth_powers += pow(y[i] - x[i], 6) / (width * height);
        const double maps[3] = {fmax(1 - (1 - (m - n) * (m - n)) * structure, 0), fmax(e, 0), fmax(-e, 0)};
        for (int j = 0; j < 3; j++) {
            sums[2 * j] += maps[j] / (width * height);
            sums[2 * j + 1] += pow(maps[j], 4) / (width * height);
        }
    }
    for (int j = 0; j < 6; j++)
        result += weights[j] * (j % 2 ? pow(sums[j], 0.25) : sums[j]);
    result += peaks * pow(sixth_powers, 1.0 / 6);
    double *all[] = {mean_x, mean_y, xx, yy, xy};
    for (int j = 0; j < 5; j++)
        free(all[j]);
    return result;
}

double oracle_visual_sum(const double *target, const double *rendering, int colours, int width, int height, int level,
                         int first, double peaks) {
    static const double weights[SCALES][6] = {{0, 7.466890328078848, 0, 0, 0, 17.445833984131262},
                                              {0, 6.683678146179332, 0, 0, 0, 1.027889937768264},
                                              {225.20515300849274, 19.213238186143016, 0, 0, 0, 0},
                                              {176.39317598450694, 24.43300999870476, 0, 0.28520802612117757, 0, 0},
                                              {0, 34.77906344483772, 0, 44.835625328877896, 0, 0}};
    picture a = luminance_of(target, colours, width, height), b = luminance_of(rendering, colours, width, height);
    double sum = 0;
    for (int scale = level; scale < SCALES && a.width >= 8 && a.height >= 8; scale++) {
        picture x = luma_of(&a), y = luma_of(&b), next[2] = {half_size(&a), half_size(&b)};
        if (scale >= first)
            sum += sum_of_maps(x.plane, y.plane, a.width, a.height, weights[scale],
                               scale == level || scale == first ? peaks : 0);
        double *all[] = {x.plane, y.plane, a.plane, b.plane};
        for (int j = 0; j < 4; j++)
            free(all[j]);
        a = next[0];
        b = next[1];
    }
    free(a.plane);
    free(b.plane);
    return sum;
}
