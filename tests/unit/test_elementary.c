/* Elementary functions: against those of the C library in long double, at special values, and bit for bit. */
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "runtime/elementary.h"

#define TRIES 20000

/* What elementary.h states.  Where long double is no wider than double, the reference is off by a rounding or two, too. */
#define RELATIVE_ERROR (6e-16L + 2 * LDBL_EPSILON)

/* 0 to 1, of a linear congruential generator. */
static double uniform(void) {
    static uint64_t state = 1;
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(state >> 11) * 0x1p-53;
}

static double between(double low, double high) {
    return low + (high - low) * uniform();
}

/* Of any size within 2^low and 2^high. */
static double power_between(double low, double high) {
    return exp2(between(low, high));
}

static void assert_close(const char *name, double x, double value, long double expected, long double error) {
    if (!(fabsl((long double)value - expected) <= error))
        fail_msg("%s of %a is %a, off by %Lg", name, x, value, (long double)value - expected);
}

static void assert_relative(const char *name, double x, double value, long double expected) {
    assert_close(name, x, value, expected, RELATIVE_ERROR * fabsl(expected));
}

/* ---- Against the C library ------------------------------------------------------------------------ */

static void test_exponentials(void **state) {
    (void)state;
    for (int i = 0; i < TRIES; i++) {
        const double small = between(-1, 1), large = between(-700, 700);
        assert_relative("exp", small, gscl_exp(small), expl(small));
        assert_relative("exp", large, gscl_exp(large), expl(large));
        assert_relative("exp2", small, gscl_exp2(small), exp2l(small));
        assert_relative("exp2", large, gscl_exp2(large), exp2l(large));
    }
}

static void test_logarithms(void **state) {
    (void)state;
    for (int i = 0; i < TRIES; i++) {
        const double near_one = between(0.5, 2), any = power_between(-1060, 1023);
        assert_relative("ln", near_one, gscl_ln(near_one), logl(near_one));
        assert_relative("ln", any, gscl_ln(any), logl(any));
        assert_relative("log2", near_one, gscl_log2(near_one), log2l(near_one));
        assert_relative("log2", any, gscl_log2(any), log2l(any));
        assert_relative("log10", near_one, gscl_log10(near_one), log10l(near_one));
        assert_relative("log10", any, gscl_log10(any), log10l(any));
    }
}

static void test_powers(void **state) {
    (void)state;
    for (int i = 0; i < TRIES; i++) {
        const double x = power_between(-30, 30), y = between(-12, 12);
        const long double expected = powl(x, y);
        assert_close("pow", x, gscl_pow(x, y), expected, RELATIVE_ERROR * expected * (1 + fabsl(y * logl(x))));
    }
}

static void test_roots(void **state) {
    (void)state;
    for (int i = 0; i < TRIES; i++) {
        const double x = power_between(-1070, 1023), y = x * power_between(-8, 8), a = between(0, 1);
        assert_relative("cbrt", a, gscl_cbrt(a), cbrtl(a));
        assert_relative("cbrt", -x, gscl_cbrt(-x), cbrtl(-x));
        if (x > 0x1p-1010 && x < 0x1p1010)
            assert_relative("hypot", x, gscl_hypot(x, -y), hypotl(x, y));
    }
}

/* An angle less a whole number of quarter turns, whose last two bits are returned: the C library of MinGW knows 66 bits of pi, which
 * is too few where the rest is small.  Each part of a quarter turn, but for the last, times the number is exact. */
static int less_quarter_turns(double x, long double *rest) {
    static const double quarter_turn[] = {0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2ep-69, 0x1.b839a252049c1p-104};
    const double count = rint(x * 0.636619772367581343);
    *rest = x;
    for (int i = 0; i < 4; i++)
        *rest -= (long double)quarter_turn[i] * count;
    return (int)((int64_t)count & 3);
}

/* The sine of an angle and `more` quarter turns. */
static long double sine(double x, int more) {
    long double rest;
    const int turns = less_quarter_turns(x, &rest) + more;
    const long double value = turns & 1 ? cosl(rest) : sinl(rest);
    return turns & 2 ? -value : value;
}

static void test_angles(void **state) {
    (void)state;
    for (int i = 0; i < TRIES; i++) {
        const double small = between(-4, 4), large = between(-1e6, 1e6);
        assert_relative("sin", small, gscl_sin(small), sine(small, 0));
        assert_relative("cos", small, gscl_cos(small), sine(small, 1));
        assert_relative("sin", large, gscl_sin(large), sine(large, 0));
        assert_relative("cos", large, gscl_cos(large), sine(large, 1));
        assert_close("tan", small, gscl_tan(small), tanl(small), 1e-15L * fabsl(tanl(small)) + 2 * LDBL_EPSILON);
    }
}

/* Doubles near multiples of a quarter turn, where one of the two is nearly 0. */
static void test_quarter_turns(void **state) {
    (void)state;
    for (int i = 1; i < TRIES; i++) {
        const double x = i * 31 * 1.57079632679489662;
        assert_relative("sin", x, gscl_sin(x), sine(x, 0));
        assert_relative("cos", x, gscl_cos(x), sine(x, 1));
    }
}

static void test_arcs(void **state) {
    (void)state;
    for (int i = 0; i < TRIES; i++) {
        const double x = between(-1, 1), y = between(-1, 1), far = power_between(-40, 40);
        assert_relative("atan2", y, gscl_atan2(y, x), atan2l(y, x));
        assert_relative("atan2", y, gscl_atan2(y, far), atan2l(y, far));
        assert_relative("atan2", y, gscl_atan2(y, -far), atan2l(y, -far));
    }
}

static void test_factorials(void **state) {
    (void)state;
    long double expected = 0;
    for (int n = 0; n < 300; n++) {
        expected += n > 0 ? log2l(n) : 0;
        assert_close("log2 n!", n, gscl_log2_factorial(n), expected, 5e-14L + 300 * RELATIVE_ERROR * expected);
    }
    for (int i = 0; i < TRIES; i++) {
        const double n = power_between(0, 40);
        const long double ln2 = 0.693147180559945309417232121458176568L, value = lgammal(n + 1.0L) / ln2;
        assert_close("log2 n!", n, gscl_log2_factorial(n), value, 5e-14L + RELATIVE_ERROR * value);
    }
}

/* ---- Special values ------------------------------------------------------------------------------- */

static void test_limits_of_exponentials(void **state) {
    (void)state;
    assert_true(gscl_exp(0.0) == 1.0 && gscl_exp2(0.0) == 1.0 && gscl_exp2(10.0) == 1024.0);
    assert_true(isinf(gscl_exp(710.0)) && isfinite(gscl_exp(709.5)) && isinf(gscl_exp2(1024.0)));
    assert_true(isinf(gscl_exp(1e300)) && gscl_exp(-1e300) == 0.0 && gscl_exp(-746.0) == 0.0);
    assert_true(isinf(gscl_exp(INFINITY)) && gscl_exp(-INFINITY) == 0.0 && gscl_exp2(-INFINITY) == 0.0);
    assert_true(gscl_exp2(-1074.0) == 0x1p-1074 && gscl_exp2(-1080.0) == 0.0 && gscl_exp2(-1022.0) == 0x1p-1022);
    assert_true(isnan(gscl_exp(NAN)) && isnan(gscl_exp2(NAN)));
}

static void test_limits_of_logarithms(void **state) {
    (void)state;
    for (int n = -1074; n < 1024; n++)
        assert_true(gscl_log2(ldexp(1.0, n)) == n);
    for (int n = 0; n <= 22; n++) /* powers of ten that are doubles */
        assert_close("log10", n, gscl_log10(pow(10.0, n)), n, n * LDBL_EPSILON);
    assert_true(gscl_ln(1.0) == 0.0 && gscl_log10(1.0) == 0.0);
    assert_true(gscl_ln(0.0) == -INFINITY && gscl_log2(-0.0) == -INFINITY && gscl_log10(0.0) == -INFINITY);
    assert_true(gscl_ln(INFINITY) == INFINITY && isnan(gscl_ln(-1.0)) && isnan(gscl_log2(-INFINITY)));
    assert_true(isnan(gscl_ln(NAN)) && isnan(gscl_log10(NAN)));
}

static void test_limits_of_powers(void **state) {
    (void)state;
    assert_true(gscl_pow(0.0, 2.4) == 0.0 && gscl_pow(0.0, 0.0) == 1.0 && isinf(gscl_pow(0.0, -1.0)));
    assert_true(gscl_pow(1.0, 1e300) == 1.0 && gscl_pow(1.0, INFINITY) == 1.0 && gscl_pow(INFINITY, -2.0) == 0.0);
    assert_true(isinf(gscl_pow(2.0, INFINITY)) && gscl_pow(0.5, INFINITY) == 0.0 && isinf(gscl_pow(INFINITY, 0.5)));
    assert_true(isnan(gscl_pow(-1.0, 0.5)) && isnan(gscl_pow(NAN, 1.0)) && isnan(gscl_pow(2.0, NAN)));
    assert_true(gscl_cbrt(0.0) == 0.0 && gscl_cbrt(INFINITY) == INFINITY && gscl_cbrt(-INFINITY) == -INFINITY);
    assert_true(gscl_cbrt(27.0) == 3.0 && gscl_cbrt(-8.0) == -2.0 && isnan(gscl_cbrt(NAN)));
}

static void test_limits_of_lengths(void **state) {
    (void)state;
    assert_true(gscl_hypot(3.0, -4.0) == 5.0 && gscl_hypot(0.0, 0.0) == 0.0 && gscl_hypot(0.0, -7.0) == 7.0);
    assert_true(gscl_hypot(0x1.8p1001, 0x1p1002) == 0x1.4p1002 && gscl_hypot(0x3p-1070, 0x4p-1070) == 0x5p-1070);
    assert_true(isinf(gscl_hypot(DBL_MAX, DBL_MAX)) && isinf(gscl_hypot(-INFINITY, NAN)) && isnan(gscl_hypot(NAN, 1)));
}

static void test_limits_of_angles(void **state) {
    (void)state;
    const double pi = 3.14159265358979324;
    assert_true(gscl_sin(0.0) == 0.0 && gscl_cos(0.0) == 1.0 && gscl_tan(0.0) == 0.0 && gscl_cos(pi) == -1.0);
    assert_true(isnan(gscl_sin(INFINITY)) && isnan(gscl_cos(-INFINITY)) && isnan(gscl_cos(NAN)));
    assert_true(fabs(gscl_sin(1e22)) <= 1.0 && fabs(gscl_cos(-1e300)) <= 1.0);
    assert_true(gscl_atan2(0.0, 1.0) == 0.0 && gscl_atan2(0.0, 0.0) == 0.0 && gscl_atan2(0.0, -1.0) == pi);
    assert_true(gscl_atan2(-0.0, -1.0) == -pi && gscl_atan2(0.0, -0.0) == pi && signbit(gscl_atan2(-0.0, 1.0)));
    assert_true(gscl_atan2(1.0, 0.0) == pi / 2 && gscl_atan2(-1.0, -0.0) == -pi / 2 && gscl_atan2(1, 1) == pi / 4);
    assert_true(gscl_atan2(INFINITY, INFINITY) == pi / 4 && gscl_atan2(-INFINITY, 1.0) == -pi / 2);
    assert_true(gscl_atan2(1.0, INFINITY) == 0.0 && gscl_atan2(1.0, -INFINITY) == pi);
    assert_true(isnan(gscl_atan2(NAN, 1.0)) && isnan(gscl_atan2(1.0, NAN)));
}

/* ---- Bit for bit ---------------------------------------------------------------------------------- */

/* Not where doubles are computed with more bits. */
#define HAS_EXACT_DOUBLES (FLT_EVAL_METHOD == 0 || FLT_EVAL_METHOD == 1)
#if HAS_EXACT_DOUBLES

static void assert_bits(double value, double expected) {
    if (memcmp(&value, &expected, sizeof value) != 0)
        fail_msg("%a instead of %a", value, expected);
}

static void test_bits(void **state) {
    (void)state;
    assert_bits(gscl_exp(1.0), 0x1.5bf0a8b14576ap+1);
    assert_bits(gscl_exp(-2.7), 0x1.13461675400c2p-4);
    assert_bits(gscl_exp2(0.3), 0x1.3b2c47bff8329p+0);
    assert_bits(gscl_ln(3.0), 0x1.193ea7aad030bp+0);
    assert_bits(gscl_log2(0.7), -0x1.0776228967d14p-1);
    assert_bits(gscl_log10(7.0), 0x1.b0b0b0b78cc3fp-1);
    assert_bits(gscl_pow(0.4, 2.4), 0x1.c6426853d20fdp-4);
    assert_bits(gscl_cbrt(0.2), 0x1.2b6b5edf6b54ap-1);
    assert_bits(gscl_sin(2.0), 0x1.d18f6ead1b445p-1);
    assert_bits(gscl_cos(100.0), 0x1.b981dbf665fdfp-1);
    assert_bits(gscl_tan(0.9), 0x1.4299ba9c2a138p+0);
    assert_bits(gscl_atan2(1.0, -3.0), 0x1.68f095fdf593cp+1);
    assert_bits(gscl_hypot(0.3, 0.7), 0x1.85ed7614b038cp-1);
    assert_bits(gscl_log2_factorial(1000.0), 0x1.0a8b2f1cd4196p+13);
}

/* All bits of many results: rounding that another machine or compiler does differently changes some of them. */
static uint64_t hash_of(uint64_t hash, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return (hash ^ bits) * UINT64_C(0x100000001b3);
}

static void test_bits_of_many(void **state) {
    (void)state;
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    for (int i = 1; i <= TRIES; i++) {
        const double x = i / 1024.0, y = (i * 7919 % TRIES - TRIES / 2) / 512.0;
        const double values[] = {gscl_exp(y),      gscl_exp2(y),          gscl_ln(x),       gscl_log2(x),
                                 gscl_log10(x),    gscl_pow(x, y),        gscl_cbrt(x),     gscl_sin(y),
                                 gscl_cos(y),      gscl_tan(x),           gscl_atan2(y, x), gscl_atan2(x, -y),
                                 gscl_hypot(x, y), gscl_log2_factorial(x)};
        for (size_t k = 0; k < sizeof values / sizeof *values; k++)
            hash = hash_of(hash, values[k]);
    }
    if (hash != UINT64_C(0x013d0792334e4f40))
        fail_msg("the hash of all results is 0x%" PRIx64, hash);
}
#endif

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exponentials),
        cmocka_unit_test(test_logarithms),
        cmocka_unit_test(test_powers),
        cmocka_unit_test(test_roots),
        cmocka_unit_test(test_angles),
        cmocka_unit_test(test_quarter_turns),
        cmocka_unit_test(test_arcs),
        cmocka_unit_test(test_factorials),
        cmocka_unit_test(test_limits_of_exponentials),
        cmocka_unit_test(test_limits_of_logarithms),
        cmocka_unit_test(test_limits_of_powers),
        cmocka_unit_test(test_limits_of_lengths),
        cmocka_unit_test(test_limits_of_angles),
#if HAS_EXACT_DOUBLES
        cmocka_unit_test(test_bits),
        cmocka_unit_test(test_bits_of_many),
#endif
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
