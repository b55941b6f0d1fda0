#include "runtime/elementary.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Polynomials are Taylor series, long enough that the first term left out is below the rounding.  Where speed counts, they
 * are summed in two halves, of even and of odd terms, which processors compute at the same time. */
#define POLYNOMIAL(x, ...) \
    polynomial(x, (const double[]){__VA_ARGS__}, sizeof((const double[]){__VA_ARGS__}) / sizeof(double))

/* The sum of coefficients[i] x^i. */
static inline double polynomial(double x, const double *coefficients, size_t count) {
    double sum = coefficients[count - 1];
    for (size_t i = count - 1; i > 0; i--)
        sum = coefficients[i - 1] + x * sum;
    return sum;
}

/* ---- Bits of doubles ------------------------------------------------------------------------------ */

#define MANTISSA_BITS 52
#define EXPONENT_BIAS 1023
#define SMALLEST_NORMAL 0x1p-1022

static uint64_t bits_of(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static double double_of(uint64_t bits) {
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* 2^n, -1022 <= n <= 1023. */
static double power_of_two(int n) {
    return double_of((uint64_t)(n + EXPONENT_BIAS) << MANTISSA_BITS);
}

/* Adding it to |x| < 2^51 leaves a number whose lowest bits are the integer nearest to x.  The sum is read as bits, because clang for
 * i386 keeps more of them in registers, and would round nothing. */
#define TO_INTEGER 0x1.8p52

static int64_t nearest_integer(double x) {
    return (int64_t)(bits_of(x + TO_INTEGER) - bits_of(TO_INTEGER));
}

/* ---- Exponential functions ------------------------------------------------------------------------ */

/* ln 2 and log10 2 in two parts.  The first has 40 bits, so that its product with an exponent is exact. */
#define LN2_HIGH 0x1.62e42fefa2p-1
#define LN2_LOW 0x1.9ef35793c7673p-41
#define LOG10_2_HIGH 0x1.34413509f6p-2
#define LOG10_2_LOW 0x1.9fef311f12b36p-42
#define INV_LN2 0x1.71547652b82fep+0  /* 1 / ln 2 */
#define INV_LN10 0x1.bcb7b1526e50ep-2 /* 1 / ln 10 */

/* e^r, |r| <= ln 2 / 2. */
static double exp_near_zero(double r) {
    const double r2 = r * r;
    const double even = POLYNOMIAL(r2, 1.0 / 2, 1.0 / 24, 1.0 / 720, 1.0 / 40320, 1.0 / 3628800, 1.0 / 479001600);
    const double odd = POLYNOMIAL(r2, 1.0 / 6, 1.0 / 120, 1.0 / 5040, 1.0 / 362880, 1.0 / 39916800, 1.0 / 6227020800);
    return 1.0 + (r + r2 * (even + r * odd));
}

/* 2^n e^r.  In two steps, of which the first never rounds, as 2^n may be beyond the range of doubles; |n| <= 2000. */
static double scaled_exp(double n, double r) {
    const int all = (int)n, half = all / 2;
    return exp_near_zero(r) * power_of_two(half) * power_of_two(all - half);
}

/* What both functions return where it does not depend on the digits of x: for |x| >= 1200, infinities and NaN. */
#define EXP_LIMIT 1200.0
static double exp_beyond(double x) {
    return isnan(x) ? x : x > 0.0 ? INFINITY : 0.0;
}

double gscl_exp(double x) {
    if (!(fabs(x) < EXP_LIMIT))
        return exp_beyond(x);
    const double n = (double)nearest_integer(x * INV_LN2);
    return scaled_exp(n, (x - n * LN2_HIGH) - n * LN2_LOW);
}

double gscl_exp2(double x) {
    if (!(fabs(x) < EXP_LIMIT))
        return exp_beyond(x);
    const double n = (double)nearest_integer(x), rest = x - n;
    return scaled_exp(n, rest * LN2_HIGH + rest * LN2_LOW);
}

/* ---- Logarithms ----------------------------------------------------------------------------------- */

#define SQRT_HALF 0x1.6a09e667f3bcdp-1

/* ln m, sqrt(1/2) <= m <= sqrt(2): 2 artanh((m - 1) / (m + 1)). */
static double ln_near_one(double m) {
    const double f = m - 1.0, s = f / (m + 1.0), s2 = s * s, s4 = s2 * s2;
    const double odd = POLYNOMIAL(s4, 1.0 / 3, 1.0 / 7, 1.0 / 11, 1.0 / 15, 1.0 / 19);
    const double even = POLYNOMIAL(s4, 1.0 / 5, 1.0 / 9, 1.0 / 13, 1.0 / 17, 1.0 / 21);
    /* 2 s = f - s f, where f is exact. */
    return f - s * (f - 2.0 * (s2 * (odd + s2 * even)));
}

/* The logarithm of x to the base b: `high` + `low` is that of 2, and `factor` 1 / ln b. */
static double logarithm(double x, double high, double low, double factor) {
    if (!(x > 0.0))
        return x == 0.0 ? -INFINITY : NAN;
    if (isinf(x))
        return x;
    const int subnormal = x < SMALLEST_NORMAL ? 54 : 0;
    const uint64_t bits = bits_of(subnormal ? x * 0x1p54 : x);
    /* x = m 2^exponent */
    const uint64_t from_one = bits - bits_of(SQRT_HALF) + bits_of(1.0);
    const int exponent = (int)(from_one >> MANTISSA_BITS) - EXPONENT_BIAS;
    const double m = double_of(bits - ((uint64_t)exponent << MANTISSA_BITS)), n = exponent - subnormal;
    return n * high + (factor * ln_near_one(m) + n * low);
}

double gscl_ln(double x) {
    return logarithm(x, LN2_HIGH, LN2_LOW, 1.0);
}

double gscl_log2(double x) {
    return logarithm(x, 1.0, 0.0, INV_LN2);
}

double gscl_log10(double x) {
    return logarithm(x, LOG10_2_HIGH, LOG10_2_LOW, INV_LN10);
}

/* Stirling's series of ln gamma(x), x >= 16. */
static double stirling(double x) {
    static const double half_ln_two_pi = 0x1.d67f1c864beb5p-1;
    const double i = 1.0 / x, i2 = i * i;
    const double series = POLYNOMIAL(i2, 1.0 / 12, -1.0 / 360, 1.0 / 1260, -1.0 / 1680, 1.0 / 1188);
    return (x - 0.5) * gscl_ln(x) - x + (half_ln_two_pi + i * series);
}

double gscl_log2_factorial(double n) {
    double x = n + 1.0, product = 1.0;
    if (isinf(n))
        return n > 0.0 ? n : NAN;
    while (x < 16.0) { /* gamma(x) = gamma(x + 1) / x */
        product *= x;
        x += 1.0;
    }
    return (stirling(x) - gscl_ln(product)) * INV_LN2;
}

/* ---- Powers and roots ----------------------------------------------------------------------------- */

double gscl_pow(double x, double y) {
    return y == 0.0 || x == 1.0 ? 1.0 : gscl_exp(y * gscl_ln(x));
}

/* x^(-1/3) of a normal number.  Dividing the bits by -3 divides the exponent, too; with this constant the error is at
 * most 3.5 percent.  Terms of the series of (1 - h)^(-1/3), h = 1 - x y^3, leave 2e-6 of it, and then less than rounding. */
static double inverse_cbrt(double x) {
    double y = double_of(UINT64_C(0x553ef00000000000) - bits_of(x) / 3), h = 1.0 - x * y * (y * y);
    y += y * h * POLYNOMIAL(h, 1.0 / 3, 2.0 / 9, 14.0 / 81, 35.0 / 243);
    h = 1.0 - x * y * (y * y);
    return y + y * h * (1.0 / 3 + h * (2.0 / 9));
}

double gscl_cbrt(double x) {
    const double size = fabs(x);
    if (!(size > 0.0) || isinf(size))
        return x;
    const int subnormal = size < SMALLEST_NORMAL;
    const double a = subnormal ? size * 0x1p54 : size, inverse = inverse_cbrt(a), square = inverse * inverse;
    double root = a * square;
    root -= (root * root * root - a) * square * (1.0 / 3); /* Newton's step for the roundings so far */
    root = subnormal ? root * 0x1p-18 : root;
    return x < 0.0 ? -root : root;
}

double gscl_hypot(double x, double y) {
    const double a = fabs(x), b = fabs(y), larger = a > b ? a : b;
    if (isinf(a) || isinf(b))
        return INFINITY;
    if (larger > 0x1p500)
        return sqrt(x * 0x1p-600 * (x * 0x1p-600) + y * 0x1p-600 * (y * 0x1p-600)) * 0x1p600;
    if (larger < 0x1p-400)
        return sqrt(x * 0x1p600 * (x * 0x1p600) + y * 0x1p600 * (y * 0x1p600)) * 0x1p-600;
    return sqrt(x * x + y * y);
}

/* ---- Angles --------------------------------------------------------------------------------------- */

/* pi / 2 in three parts.  The first two have 33 bits, so that their products with quarter turns are exact. */
#define HALF_PI_HIGH 0x1.921fb544p+0
#define HALF_PI_MIDDLE 0x1.0b4611a6p-34
#define HALF_PI_LOW 0x1.3198a2e037073p-69
#define MAX_ANGLE 0x1p20 /* beyond it they are not */
#define TWO_PI 0x1.921fb54442d18p+2
#define INV_HALF_PI 0x1.45f306dc9c883p-1 /* 2 / pi */

/* pi in two parts. */
#define PI 0x1.921fb54442d18p+1
#define PI_LOW 0x1.1a62633145c07p-53

/* |r| <= pi / 4 */
static double sin_near_zero(double r) {
    const double r2 = r * r;
    const double series = POLYNOMIAL(r2, -1.0 / 6, 1.0 / 120, -1.0 / 5040, 1.0 / 362880, -1.0 / 39916800,
                                     1.0 / 6227020800, -1.0 / 1307674368000, 1.0 / 355687428096000);
    return r + r * r2 * series;
}

static double cos_near_zero(double r) {
    const double r2 = r * r;
    const double series = POLYNOMIAL(r2, 1.0 / 24, -1.0 / 720, 1.0 / 40320, -1.0 / 3628800, 1.0 / 479001600,
                                     -1.0 / 87178291200, 1.0 / 20922789888000);
    return (1.0 - 0.5 * r2) + r2 * r2 * series;
}

/* The sine of x + `quarters` quarter turns. */
static double shifted_sin(double x, unsigned quarters) {
    if (!(fabs(x) <= MAX_ANGLE))
        x = fmod(x, TWO_PI);
    const int64_t count = nearest_integer(x * INV_HALF_PI);
    const double n = (double)count;
    const double r = ((x - n * HALF_PI_HIGH) - n * HALF_PI_MIDDLE) - n * HALF_PI_LOW;
    quarters += (unsigned)(count & 3);
    const double value = quarters % 2 ? cos_near_zero(r) : sin_near_zero(r);
    return quarters & 2 ? -value : value;
}

double gscl_sin(double x) {
    return shifted_sin(x, 0);
}

double gscl_cos(double x) {
    return shifted_sin(x, 1);
}

double gscl_tan(double x) {
    return gscl_sin(x) / gscl_cos(x);
}

/* 0 <= t <= 1: the arc of the nearest eighth and that of the rest. */
static double arc_tangent(double t) {
    static const double eighths[] = {0.0,
                                     0.12435499454676144,
                                     0.24497866312686414,
                                     0.35877067027057225,
                                     0.4636476090008061,
                                     0.5585993153435624,
                                     0.6435011087932844,
                                     0.7188299996216245,
                                     0.7853981633974483};
    const int k = (int)(8.0 * t + 0.5);
    const double near = k / 8.0, u = (t - near) / (1.0 + t * near), u2 = u * u;
    const double series = POLYNOMIAL(u2, -1.0 / 3, 1.0 / 5, -1.0 / 7, 1.0 / 9, -1.0 / 11, 1.0 / 13);
    return eighths[k] + (u + u * u2 * series);
}

/* min / max of two sizes, of which 0 / 0 is 0 and infinity / infinity 1. */
static double size_ratio(double a, double b) {
    return a == b ? (a > 0.0 ? 1.0 : 0.0) : a < b ? a / b : b / a;
}

double gscl_atan2(double y, double x) {
    if (isnan(x) || isnan(y))
        return NAN;
    const double arc = arc_tangent(size_ratio(fabs(x), fabs(y)));
    double angle;
    if (fabs(y) > fabs(x))
        angle = signbit(x) ? PI / 2 + (arc + PI_LOW / 2) : PI / 2 - (arc - PI_LOW / 2);
    else
        angle = signbit(x) ? PI - (arc - PI_LOW) : arc;
    return signbit(y) ? -angle : angle;
}
