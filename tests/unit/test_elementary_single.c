/* The elementary functions in single precision against those of the C library in double precision. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/elementary.h"

#define MAX_ERROR 4e-7

/* `scale`: the size to which the error is relative. */
static void check(const char *name, double x, double value, double expected, double scale) {
    if (!(fabs(value - expected) <= MAX_ERROR * scale))
        fail_msg("%s(%.9g) is %.9g, not %.9g", name, x, value, expected);
}

static void test_exponentials(void **state) {
    (void)state;
    for (float x = -80.0f; x <= 80.0f; x += 0.0137f) {
        check("exp", (double)x, (double)gscl_exp(x), exp((double)x), exp((double)x));
        check("exp2", (double)x, (double)gscl_exp2(x), exp2((double)x), exp2((double)x));
    }
    assert_true(gscl_exp(0.0f) == 1.0f && gscl_exp2(-3.0f) == 0.125f);
    assert_true(gscl_exp(-200.0f) == 0.0f && isinf(gscl_exp(200.0f)) && gscl_exp2(-1e30f) == 0.0f);
}

static void test_logarithm(void **state) {
    (void)state;
    for (float x = 1e-35f; x < 1e35f; x *= 1.0137f)
        check("ln", (double)x, (double)gscl_ln(x), log((double)x), fmax(fabs(log((double)x)), 0.5));
    for (float x = 0.9f; x < 1.1f; x += 0.000137f)
        check("ln", (double)x, (double)gscl_ln(x), log((double)x), fabs(log((double)x)) + 1e-30);
}

static void test_angles(void **state) {
    (void)state;
    for (float x = -20.0f; x <= 20.0f; x += 0.00137f) {
        check("sin", (double)x, (double)gscl_sin(x), sin((double)x), 1);
        check("cos", (double)x, (double)gscl_cos(x), cos((double)x), 1);
    }
}

static void test_arc_tangent(void **state) {
    (void)state;
    for (float turn = -3.14f; turn <= 3.14f; turn += 0.00137f)
        for (float size = 1e-12f; size < 1e13f; size *= 1e6f) {
            const float x = size * cosf(turn), y = size * sinf(turn);
            check("atan2", (double)turn, (double)gscl_atan2(y, x), atan2((double)y, (double)x), 1);
            check("hypot", (double)turn, (double)gscl_hypot(x, y), hypot((double)x, (double)y), (double)size);
        }
    assert_true(gscl_atan2(0.0f, 0.0f) == 0.0f && gscl_atan2(0.0f, 1.0f) == 0.0f);
    check("atan2", 0, (double)gscl_atan2(0.0f, -1.0f), atan2(0, -1), 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exponentials),
        cmocka_unit_test(test_logarithm),
        cmocka_unit_test(test_angles),
        cmocka_unit_test(test_arc_tangent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
