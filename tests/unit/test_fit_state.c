/* The state of a fit on the device: its pyramid, the order of its splats, and the reset of skipped tiles. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "cl/constants.h"
#include "fit/fit.h"
#include "fit/tunables.h"
#include "one_context.h"

#define WIDTH 131 /* odd at two levels */
#define HEIGHT 70
#define PLANE (WIDTH * HEIGHT)
#define SPLATS 5

static float planes[PLANE];

static gscl_fit fit_of_a_ramp(void) {
    const gscl_kernel_options options = {.blend = GSCL_NORMALIZED, .colours = 1};
    gscl_fit fit;
    for (int i = 0; i < PLANE; i++)
        planes[i] = 0.1f + 0.005f * (float)(i % WIDTH);
    assert_int_equal(gscl_fit_create(&fit, context, &options, WIDTH, HEIGHT, 0, planes), GSCL_OK);
    return fit;
}

static void append_splats(gscl_fit *fit) {
    float params[SPLATS * GSCL_PARAMS] = {0};
    for (int i = 0; i < SPLATS; i++) {
        float *p = params + i * GSCL_PARAMS;
        p[GSCL_X] = 20.0f + 20.0f * (float)i;
        p[GSCL_Y] = 35.0f;
        p[GSCL_LOG_S1] = p[GSCL_LOG_S2] = 1.5f;
        p[GSCL_COLOUR] = 0.2f * (float)i;
    }
    assert_int_equal(gscl_fit_append(fit, params, SPLATS), GSCL_OK);
}

static void test_levels_end_at_the_smallest_side(void **unused) {
    (void)unused;
    gscl_fit fit = fit_of_a_ramp();
    const gscl_pyramid *p = &fit.pyramid;
    assert_int_equal(p->last_level, 1); /* 35 pixels high; the next level would have 18 */
    assert_true(gscl_pyramid_height(p, p->last_level) >= (uint32_t)gscl_fit_tunables.min_level_side);
    assert_int_equal(gscl_pyramid_width(p, 1), 66);
    assert_int_equal(gscl_pyramid_pixels(p, 1), 66 * 35);
    gscl_fit_free(&fit);
}

static void test_levels_are_means_of_pixels(void **unused) {
    (void)unused;
    static float half[66 * 35];
    gscl_fit fit = fit_of_a_ramp();
    assert_int_equal(gscl_fit_set_level(&fit, 1), GSCL_OK);
    assert_int_equal(gscl_fit_target_samples(&fit, 0, 66 * 35, half), GSCL_OK);
    for (int i = 0; i < 66 * 35; i++) {
        int x = 2 * (i % 66), right = x + 1 < WIDTH ? x + 1 : x;
        assert_float_equal(half[i], (planes[x] + planes[right]) / 2, 1e-6);
    }
    gscl_fit_free(&fit);
}

static void test_levels_are_clamped(void **unused) {
    (void)unused;
    gscl_fit fit = fit_of_a_ramp();
    assert_int_equal(gscl_fit_set_level(&fit, 9), GSCL_OK);
    assert_int_equal(fit.level, 1);
    assert_int_equal(gscl_fit_level_width(&fit), 66);
    assert_int_equal(gscl_fit_set_level(&fit, -1), GSCL_OK);
    assert_int_equal(fit.level, 0);
    gscl_fit_free(&fit);
}

/* Splats are moved and removed together with their moments and ages. */
static void test_reordering_keeps_the_optimiser(void **unused) {
    (void)unused;
    static const size_t order[3] = {4, 0, 2};
    float params[2][SPLATS * GSCL_PARAMS], moments[2][SPLATS * GSCL_PARAMS];
    cl_int ages[3];
    gscl_fit fit = fit_of_a_ramp();
    append_splats(&fit);
    assert_int_equal(gscl_fit_step(&fit, 1.0f), GSCL_OK);
    for (int after = 0; after < 2; after++) {
        if (after)
            assert_int_equal(gscl_fit_reorder(&fit, order, 3), GSCL_OK);
        size_t bytes = (size_t)fit.renderer.count * GSCL_PARAMS * sizeof(float);
        assert_int_equal(gscl_fit_read(&fit, params[after]), GSCL_OK);
        assert_int_equal(gscl_buffer_read(context, &fit.first_moment, 0, moments[after], bytes), GSCL_OK);
    }
    assert_int_equal(gscl_buffer_read(context, &fit.ages, 0, ages, sizeof ages), GSCL_OK);
    assert_int_equal(fit.renderer.count, 3);
    for (int i = 0; i < 3; i++) {
        size_t from = order[i] * GSCL_PARAMS, to = (size_t)i * GSCL_PARAMS;
        assert_memory_equal(params[1] + to, params[0] + from, GSCL_PARAMS * sizeof(float));
        assert_memory_equal(moments[1] + to, moments[0] + from, GSCL_PARAMS * sizeof(float));
        assert_true(moments[1][to + GSCL_COLOUR] != 0);
        assert_int_equal(ages[i], 1);
    }
    gscl_fit_free(&fit);
}

static void test_fixed_splats_stay(void **unused) {
    (void)unused;
    float before[SPLATS * GSCL_PARAMS], after[SPLATS * GSCL_PARAMS];
    gscl_fit fit = fit_of_a_ramp();
    append_splats(&fit);
    fit.fixed = 2;
    assert_int_equal(gscl_fit_read(&fit, before), GSCL_OK);
    for (int step = 0; step < 3; step++)
        assert_int_equal(gscl_fit_step(&fit, 1.0f), GSCL_OK);
    assert_int_equal(gscl_fit_read(&fit, after), GSCL_OK);
    assert_memory_equal(before, after, fit.fixed * GSCL_PARAMS * sizeof(float));
    for (size_t i = fit.fixed; i < SPLATS; i++)
        assert_true(before[i * GSCL_PARAMS + GSCL_COLOUR] != after[i * GSCL_PARAMS + GSCL_COLOUR]);
    gscl_fit_free(&fit);
}

static int skipped_tiles(gscl_fit *fit) {
    enum { TILES = 9 * 5 };
    cl_int skip_until[TILES];
    int count = 0;
    assert_int_equal(gscl_buffer_read(context, &fit->skip.skip_until, 0, skip_until, sizeof skip_until), GSCL_OK);
    for (int i = 0; i < TILES; i++)
        count += skip_until[i] > fit->skip.step;
    return count;
}

/* Tiles are skipped where the splats match the image, until new splats arrive. */
static void test_new_splats_end_skipping(void **unused) {
    (void)unused;
    gscl_fit fit;
    const gscl_kernel_options options = {.blend = GSCL_NORMALIZED, .colours = 1};
    for (int i = 0; i < PLANE; i++)
        planes[i] = i % WIDTH < WIDTH / 2 ? 0.5f : 0.5f + (i % 2 ? 0.4f : -0.4f);
    assert_int_equal(gscl_fit_create(&fit, context, &options, WIDTH, HEIGHT, 0, planes), GSCL_OK);
    append_splats(&fit);
    for (int step = 0; step <= gscl_fit_tunables.check_interval; step++)
        assert_int_equal(gscl_fit_step(&fit, 1e-6f), GSCL_OK);
    assert_true(skipped_tiles(&fit) > 0);
    assert_true(fit.skip.threshold > 0);
    append_splats(&fit);
    assert_int_equal(skipped_tiles(&fit), 0);
    assert_true(fit.skip.threshold == 0);
    gscl_fit_free(&fit);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_levels_end_at_the_smallest_side),
        cmocka_unit_test(test_levels_are_means_of_pixels),
        cmocka_unit_test(test_levels_are_clamped),
        cmocka_unit_test(test_reordering_keeps_the_optimiser),
        cmocka_unit_test(test_fixed_splats_stay),
        cmocka_unit_test(test_new_splats_end_skipping),
    };
    return cmocka_run_group_tests(tests, open_context, close_context);
}
