#include "decode/resize.h"

#include "cl/constants.h"
#include "runtime/elementary.h"

static gscl_real box_variance(gscl_real scale) {
    return scale < 1 ? (1 / (scale * scale) - 1) / 12 : 0;
}

/* A splat whose area is `growth` times as large weighs as much as before: its opacity o is 1 / (1 + e^-logit), and
 * 1 / (o / growth) - 1 = growth - 1 + growth e^-logit. */
static void weaken(float *p, gscl_real growth) {
    p[GSCL_OPACITY] = -(float)gscl_ln(growth - 1 + growth * gscl_exp(-(gscl_real)p[GSCL_OPACITY]));
}

/* Transforms a covariance and decomposes it into axes and angle.  Returns the factor by which a box filter makes the area
 * larger. */
static gscl_real resize_shape(float *p, gscl_real sx, gscl_real sy) {
    const gscl_real v1 = gscl_exp(2 * (gscl_real)p[GSCL_LOG_S1]), v2 = gscl_exp(2 * (gscl_real)p[GSCL_LOG_S2]);
    const gscl_real c = gscl_cos(p[GSCL_THETA]), s = gscl_sin(p[GSCL_THETA]);
    const gscl_real along_x = c * c * v1 + s * s * v2, along_y = s * s * v1 + c * c * v2;
    const gscl_real box_x = box_variance(sx), box_y = box_variance(sy);
    const gscl_real xx = (along_x + box_x) * sx * sx, yy = (along_y + box_y) * sy * sy;
    const gscl_real xy = c * s * (v1 - v2) * sx * sy;
    /* xx * yy - xy * xy without the digits that cancel each other */
    const gscl_real widened = v1 * v2 + along_x * box_y + (along_y + box_y) * box_x;
    const gscl_real determinant = widened * sx * sx * sy * sy;
    const gscl_real large = (xx + yy) / 2 + gscl_hypot((xx - yy) / 2, xy);
    const gscl_real thinnest = GSCL_REAL(0x1p-40); /* bounds the aspect by 2^20 */
    p[GSCL_LOG_S1] = (float)(gscl_ln(large) / 2);
    p[GSCL_LOG_S2] = (float)(gscl_ln(determinant / large + thinnest * large) / 2);
    p[GSCL_THETA] = (float)(gscl_atan2(2 * xy, xx - yy) / 2);
    return gscl_real_sqrt(widened / (v1 * v2));
}

/* The wave keeps its place in the image; the box filter lowers its amplitude. */
static void resize_wave(float *p, gscl_real sx, gscl_real sy) {
    const gscl_real pi = GSCL_REAL(3.14159265358979323846), x = p[GSCL_WAVE_X], y = p[GSCL_WAVE_Y];
    const gscl_real blur = x * x * box_variance(sx) + y * y * box_variance(sy);
    p[GSCL_WAVE_X] = (float)(x / sx);
    p[GSCL_WAVE_Y] = (float)(y / sy);
    p[GSCL_WAVE_AMPLITUDE] *= (float)gscl_exp(-2 * pi * pi * blur);
}

void gscl_resize_splats(float *params, size_t count, gscl_real sx, gscl_real sy) {
    if (sx == 1 && sy == 1)
        return;
    for (size_t i = 0; i < count; i++) {
        float *p = params + i * GSCL_PARAMS;
        p[GSCL_X] = (float)(p[GSCL_X] * sx);
        p[GSCL_Y] = (float)(p[GSCL_Y] * sy);
        weaken(p, resize_shape(p, sx, sy));
        resize_wave(p, sx, sy);
    }
}
