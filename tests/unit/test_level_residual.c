/* The residual of a level of the pyramid after prediction from the next smaller one (gscl_fit_level_residual). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "cl/constants.h"
#include "fit/fit.h"
#include "runtime/queue.h"
#define TESTS_KERNELS
#include "one_context.h"

#define WIDTH 94 /* not a multiple of a tile */
#define HEIGHT 70
#define CHANNELS 3

typedef float painter(int x, int y, int channel);

/* Residual of an image's finest level. */
static double residual_of(painter *paint) {
    static float planes[CHANNELS * HEIGHT * WIDTH];
    for (int k = 0; k < CHANNELS; k++)
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++)
                planes[(k * HEIGHT + y) * WIDTH + x] = paint(x, y, k);
    const gscl_kernel_options options = {.blend = GSCL_NORMALIZED, .colours = CHANNELS};
    gscl_fit fit = {0};
    float *map = NULL;
    assert_int_equal(gscl_fit_create(&fit, context, &options, WIDTH, HEIGHT, 0, planes), GSCL_OK);
    assert_int_equal(gscl_fit_begin_level_residual(&fit, 0, &map), GSCL_OK);
    assert_int_equal(gscl_finish(context), GSCL_OK);
    const double residual = gscl_fit_level_residual(&fit, 0, map);
    free(map);
    gscl_fit_free(&fit);
    return residual;
}

static float ramp(int x, int y, int channel) {
    return 0.1f + 0.005f * (float)x + 0.004f * (float)y * (float)channel;
}
static void test_slopes_leave_no_residual(void **unused) {
    (void)unused;
    assert_float_equal(residual_of(ramp), 0, 1e-9);
}

static float checkers(int x, int y, int channel) {
    return 0.5f + ((x + y) % 2 ? 0.1f : -0.1f) * (channel == 1 ? 2.0f : 1.0f);
}
static void test_single_pixels_leave_a_residual(void **unused) {
    (void)unused;
    assert_float_equal(residual_of(checkers), (0.01 + 0.04 + 0.01) / 3, 1e-6);
}

static float one_checkered_tile(int x, int y, int channel) {
    return x < GSCL_TILE && y < GSCL_TILE ? checkers(x, y, channel) : 0.5f;
}
/* One tile of thirty exceeds the share of 1 % that the residual ignores. */
static void test_a_small_object_counts_in_full(void **unused) {
    (void)unused;
    double all = residual_of(checkers), one = residual_of(one_checkered_tile);
    assert_true(one > 0.5 * all);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_slopes_leave_no_residual),
        cmocka_unit_test(test_single_pixels_leave_a_residual),
        cmocka_unit_test(test_a_small_object_counts_in_full),
    };
    return cmocka_run_group_tests(tests, open_context, close_context);
}
