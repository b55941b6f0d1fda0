#include "decode/resize.h"

#include <math.h>

#include "cl/constants.h"
#include "runtime/elementary.h"

static double box_variance(double scale) {
    return scale < 1 ? (1 / (scale * scale) - 1) / 12 : 0;
}

/* Transforms a covariance and decomposes it into axes and angle. */
static void resize_shape(float *p, double sx, double sy) {
    double v1 = gscl_exp(2.0 * p[GSCL_LOG_S1]), v2 = gscl_exp(2.0 * p[GSCL_LOG_S2]);
    double c = gscl_cos(p[GSCL_THETA]), s = gscl_sin(p[GSCL_THETA]);
    double xx = (c * c * v1 + s * s * v2 + box_variance(sx)) * sx * sx;
    double yy = (s * s * v1 + c * c * v2 + box_variance(sy)) * sy * sy;
    double xy = c * s * (v1 - v2) * sx * sy;
    double mean = (xx + yy) / 2, half = gscl_hypot((xx - yy) / 2, xy);
    double large = mean + half, small = fmax((xx * yy - xy * xy) / large, 1e-6 * large * 1e-6);
    p[GSCL_LOG_S1] = (float)(0.5 * gscl_ln(large));
    p[GSCL_LOG_S2] = (float)(0.5 * gscl_ln(small));
    p[GSCL_THETA] = (float)(0.5 * gscl_atan2(2 * xy, xx - yy));
}

/* The wave keeps its place in the image; the box filter lowers its amplitude. */
static void resize_wave(float *p, double sx, double sy) {
    const double pi = 3.14159265358979323846, x = (double)p[GSCL_WAVE_X], y = (double)p[GSCL_WAVE_Y];
    const double blur = x * x * box_variance(sx) + y * y * box_variance(sy);
    p[GSCL_WAVE_X] = (float)(x / sx);
    p[GSCL_WAVE_Y] = (float)(y / sy);
    p[GSCL_WAVE_AMPLITUDE] *= (float)gscl_exp(-2 * pi * pi * blur);
}

void gscl_resize_splats(float *params, size_t count, double sx, double sy) {
    if (sx == 1 && sy == 1)
        return;
    for (size_t i = 0; i < count; i++) {
        float *p = params + i * GSCL_PARAMS;
        p[GSCL_X] = (float)(p[GSCL_X] * sx);
        p[GSCL_Y] = (float)(p[GSCL_Y] * sy);
        resize_shape(p, sx, sy);
        resize_wave(p, sx, sy);
    }
}
