/* The elementary functions that drawing needs, in single precision: for programs that are compiled with
 * GSCL_SINGLE_PRECISION.  Relative errors are below 4e-7, as far as the argument is exact. */
#include "runtime/elementary.h"

#include <stdint.h>
#include <string.h>

#define MANTISSA_BITS 23
#define EXPONENT_BIAS 127

static uint32_t bits_of(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static float float_of(uint32_t bits) {
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* 2^n, -126 <= n <= 127. */
static float power_of_two(int n) {
    return float_of((uint32_t)(n + EXPONENT_BIAS) << MANTISSA_BITS);
}

/* The integer that is nearest to x, |x| < 2^30. */
static int nearest_integer(float x) {
    return (int)(x < 0.0f ? x - 0.5f : x + 0.5f);
}

/* ---- Exponential functions and logarithms ---- */

#define LN2 0.693147181f
/* ln 2 in two parts.  The first has 15 bits, so that its product with an exponent is exact. */
#define LN2_HIGH 0.693145752f
#define LN2_LOW 1.42860677e-6f
#define INV_LN2 1.44269504f
#define LARGEST_EXPONENT \
    100.0f /* beyond it, e^x and 2^x count as 0 or as infinite: no parameter of a splat comes near */

/* 2^n e^r, |r| <= ln 2 / 2, |n| <= 150.  In two steps, as 2^n may be beyond the range of floats. */
static float scaled_exp(int n, float r) {
    const float series =
        1.0f +
        r * (1.0f + r * (0.5f + r * (1.0f / 6 + r * (1.0f / 24 + r * (1.0f / 120 + r * (1.0f / 720 + r / 5040))))));
    return series * power_of_two(n / 2) * power_of_two(n - n / 2);
}

static float exp_beyond(float x) {
    return x > 0.0f ? INFINITY : 0.0f;
}

float gscl_exp(float x) {
    if (!(fabsf(x) < LARGEST_EXPONENT))
        return exp_beyond(x);
    const int n = nearest_integer(x * INV_LN2);
    return scaled_exp(n, (x - (float)n * LN2_HIGH) - (float)n * LN2_LOW);
}

float gscl_exp2(float x) {
    if (!(fabsf(x) < LARGEST_EXPONENT))
        return exp_beyond(x);
    const int n = nearest_integer(x);
    return scaled_exp(n, (x - (float)n) * LN2);
}

#define SQRT_HALF 0.707106781f

/* Of normal numbers above 0. */
float gscl_ln(float x) {
    const uint32_t from_one = bits_of(x) - bits_of(SQRT_HALF) + bits_of(1.0f);
    const int exponent = (int)(from_one >> MANTISSA_BITS) - EXPONENT_BIAS;
    const float m = float_of(bits_of(x) - ((uint32_t)exponent << MANTISSA_BITS)), n = (float)exponent;
    /* 2 artanh((m - 1) / (m + 1)) */
    const float s = (m - 1.0f) / (m + 1.0f), s2 = s * s;
    const float series = 2.0f * s * (1.0f + s2 * (1.0f / 3 + s2 * (1.0f / 5 + s2 * (1.0f / 7 + s2 / 9))));
    return n * LN2_HIGH + (series + n * LN2_LOW);
}

float gscl_hypot(float x, float y) {
    return gscl_real_sqrt(x * x + y * y);
}

/* ---- Angles ---- */

/* pi / 2 in three parts.  The first two have few bits, so that their products with quarter turns are exact. */
#define HALF_PI_HIGH 1.57031250f
#define HALF_PI_MIDDLE 4.83751297e-4f
#define HALF_PI_LOW 7.54978995e-8f
#define INV_HALF_PI 0.636619772f
#define PI 3.14159265f

/* The sine of x + `quarters` quarter turns, |x| <= 1000. */
static float shifted_sin(float x, unsigned quarters) {
    const int n = nearest_integer(x * INV_HALF_PI);
    const float r = ((x - (float)n * HALF_PI_HIGH) - (float)n * HALF_PI_MIDDLE) - (float)n * HALF_PI_LOW, r2 = r * r;
    const float sine = r + r * r2 * (-1.0f / 6 + r2 * (1.0f / 120 + r2 * (-1.0f / 5040 + r2 / 362880)));
    const float cosine =
        1.0f - 0.5f * r2 + r2 * r2 * (1.0f / 24 + r2 * (-1.0f / 720 + r2 * (1.0f / 40320 - r2 / 3628800)));
    quarters += (unsigned)n;
    const float value = quarters % 2 ? cosine : sine;
    return quarters & 2 ? -value : value;
}

float gscl_sin(float x) {
    return shifted_sin(x, 0);
}

float gscl_cos(float x) {
    return shifted_sin(x, 1);
}

/* The arc of t, 0 <= t <= 1, is that of the nearest eighth and that of the rest. */
static float arc_tangent(float t) {
    static const float eighths[] = {0.0f,         0.124354995f, 0.244978663f, 0.358770670f, 0.463647609f,
                                    0.558599315f, 0.643501109f, 0.718830000f, 0.785398163f};
    const int k = (int)(8.0f * t + 0.5f);
    const float near = (float)k / 8.0f, u = (t - near) / (1.0f + t * near), u2 = u * u;
    return eighths[k] + u * (1.0f + u2 * (-1.0f / 3 + u2 * (1.0f / 5 - u2 / 7)));
}

float gscl_atan2(float y, float x) {
    const float a = fabsf(x), b = fabsf(y), larger = a > b ? a : b, lesser = a > b ? b : a;
    const float arc = larger > 0.0f ? arc_tangent(lesser / larger) : 0.0f;
    const float acute = b > a ? PI / 2 - arc : arc;
    const float angle = x < 0.0f ? PI - acute : acute;
    return y < 0.0f ? -angle : angle;
}
