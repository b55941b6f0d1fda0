/* The state of a fit on the device: its pyramid, the order of its splats, the reset of skipped tiles, sums over an image, and
 * when the host waits for it. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cl/constants.h"
#include "fit/fit.h"
#include "fit/tunables.h"
#define TESTS_KERNELS
#include "one_context.h"

#define WIDTH 131 /* odd at two levels */
#define HEIGHT 70
#define PLANE (WIDTH * HEIGHT)
#define SPLATS 5

static float planes[PLANE];

/* `weighted`: GSCL_WEIGHTED_... */
static gscl_fit weighted_fit_of_a_ramp(int weighted) {
    const gscl_kernel_options options = {.blend = GSCL_NORMALIZED, .colours = 1, .weighted = weighted};
    gscl_fit fit;
    for (int i = 0; i < PLANE; i++)
        planes[i] = 0.1f + 0.005f * (float)(i % WIDTH);
    assert_int_equal(gscl_fit_create(&fit, context, &options, WIDTH, HEIGHT, 0, planes), GSCL_OK);
    return fit;
}

static gscl_fit fit_of_a_ramp(void) {
    return weighted_fit_of_a_ramp(GSCL_WEIGHTED_NOT);
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
    assert_int_equal(gscl_buffer_read(context, &fit.pyramid.levels[1], 0, half, sizeof half), GSCL_OK);
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

/* A step after the release of scratch memory is the step without it, at all levels. */
static void test_released_scratch_comes_back(void **unused) {
    (void)unused;
    float params[2][SPLATS * GSCL_PARAMS];
    static float half[2][66 * 35], error[2][66 * 35];
    for (int released = 0; released < 2; released++) {
        gscl_fit fit = fit_of_a_ramp();
        append_splats(&fit);
        for (int step = 0; step < 4; step++) {
            fit.has_old_lists = true;
            assert_int_equal(gscl_fit_step(&fit, 1.0f, 1), GSCL_OK);
            if (released)
                gscl_fit_release_scratch(&fit);
            if (step == 0)
                assert_true((fit.pyramid.levels[1].memory == NULL) == (released == 1));
            assert_int_equal(gscl_fit_set_level(&fit, step), GSCL_OK);
        }
        assert_int_equal(
            gscl_buffer_read(context, &fit.pyramid.levels[fit.level], 0, half[released], sizeof half[released]),
            GSCL_OK);
        assert_int_equal(gscl_fit_error(&fit, error[released]), GSCL_OK);
        assert_int_equal(gscl_fit_read(&fit, params[released]), GSCL_OK);
        gscl_fit_free(&fit);
    }
    assert_memory_equal(params[0], params[1], sizeof params[0]);
    assert_memory_equal(half[0], half[1], sizeof half[0]);
    assert_memory_equal(error[0], error[1], sizeof error[0]);
}

/* Before there is a model, levels have weights of zero: those that were released and made again, too. */
static void test_weights_begin_at_zero(void **unused) {
    (void)unused;
    static float weights[2 * PLANE];
    gscl_fit fit = weighted_fit_of_a_ramp(GSCL_WEIGHTED_LUMA);
    for (int released = 0; released < 2; released++) {
        if (released) {
            gscl_pyramid_release_smaller(&fit.pyramid, 0);
            assert_null(fit.pyramid.levels[1].memory);
        }
        for (int level = 0; level < 2; level++) {
            assert_int_equal(gscl_fit_set_level(&fit, level), GSCL_OK);
            const size_t plane = gscl_fit_level_pixels(&fit);
            assert_int_equal(gscl_buffer_read(context, &fit.pyramid.levels[level], plane * sizeof(float), weights,
                                              2 * plane * sizeof(float)),
                             GSCL_OK);
            for (size_t i = 0; i < 2 * plane; i++)
                assert_true(weights[i] == 0);
        }
    }
    gscl_fit_free(&fit);
}

/* Splats are moved and removed together with their moments and ages. */
static void test_reordering_keeps_the_optimiser(void **unused) {
    (void)unused;
    static const size_t order[3] = {4, 0, 2};
    float params[2][SPLATS * GSCL_PARAMS], moments[2][SPLATS * GSCL_PARAMS];
    int32_t ages[3];
    gscl_fit fit = fit_of_a_ramp();
    append_splats(&fit);
    assert_int_equal(gscl_fit_step(&fit, 1.0f, 1), GSCL_OK);
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
        assert_int_equal(gscl_fit_step(&fit, 1.0f, 1), GSCL_OK);
    assert_int_equal(gscl_fit_read(&fit, after), GSCL_OK);
    assert_memory_equal(before, after, fit.fixed * GSCL_PARAMS * sizeof(float));
    for (size_t i = fit.fixed; i < SPLATS; i++)
        assert_true(before[i * GSCL_PARAMS + GSCL_COLOUR] != after[i * GSCL_PARAMS + GSCL_COLOUR]);
    gscl_fit_free(&fit);
}

static int skipped_tiles(gscl_fit *fit) {
    enum { TILES = 9 * 5 };
    int32_t skip_until[TILES];
    int count = 0;
    assert_int_equal(gscl_buffer_read(context, &fit->skip.skip_until, 0, skip_until, sizeof skip_until), GSCL_OK);
    for (int i = 0; i < TILES; i++)
        count += skip_until[i] > fit->skip.step;
    return count;
}

static gscl_fit_control read_control(const gscl_fit *fit) {
    gscl_fit_control control;
    assert_int_equal(gscl_buffer_read(context, &fit->control, 0, &control, sizeof control), GSCL_OK);
    return control;
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
        assert_int_equal(gscl_fit_step(&fit, 1e-6f, 1), GSCL_OK);
    assert_true(skipped_tiles(&fit) > 0);
    assert_true(read_control(&fit).skip_threshold > 0);
    append_splats(&fit);
    assert_int_equal(skipped_tiles(&fit), 0);
    assert_true(read_control(&fit).skip_threshold == 0);
    gscl_fit_free(&fit);
}

/* Steps do not wait for the device, but where the lengths of the lists are not known or their interval has passed, which
 * grows each time. */
static void test_steps_do_not_wait(void **unused) {
    (void)unused;
    gscl_fit fit = fit_of_a_ramp();
    append_splats(&fit);
    assert_int_equal(gscl_fit_step(&fit, 1.0f, 1), GSCL_OK);
    uint64_t waits = context->waits, expected = 0;
    for (int interval = gscl_fit_tunables.check_interval; interval < gscl_fit_tunables.max_wait_interval;
         interval *= gscl_fit_tunables.wait_growth)
        expected++;
    for (int step = 1; step < gscl_fit_tunables.max_wait_interval; step++)
        assert_int_equal(gscl_fit_step(&fit, 1.0f, 1), GSCL_OK);
    assert_in_range(context->waits - waits, expected, expected + 1); /* the first lists may have been too short */
    waits = context->waits;
    append_splats(&fit);
    assert_int_equal(gscl_fit_step(&fit, 1.0f, 1), GSCL_OK);
    assert_true(context->waits > waits);
    assert_true(fit.known_loss > 0 && fit.known_loss < 1);
    gscl_fit_free(&fit);
}

/* More entries than the bound: the device reduces the largest axis, with each check. */
static void test_long_lists_bound_axes(void **unused) {
    (void)unused;
    enum { MANY = 2500 }; /* each on most of the 45 tiles, of which 24 a tile are allowed and 4 for each splat */
    static float params[MANY * GSCL_PARAMS];
    gscl_fit fit = fit_of_a_ramp();
    for (int i = 0; i < MANY; i++) {
        float *p = params + i * GSCL_PARAMS;
        p[GSCL_X] = 65.0f;
        p[GSCL_Y] = 35.0f;
        p[GSCL_LOG_S1] = p[GSCL_LOG_S2] = 3.0f;
    }
    const float first = read_control(&fit).log_max;
    assert_true(first == fit.limits.log_max);
    assert_int_equal(gscl_fit_append(&fit, params, MANY), GSCL_OK);
    assert_int_equal(gscl_fit_step(&fit, 1e-6f, 1), GSCL_OK);
    const float second = read_control(&fit).log_max;
    assert_float_equal(second, first - gscl_fit_tunables.axis_reduction, 1e-5);
    for (int step = 1; step < gscl_fit_tunables.check_interval; step++)
        assert_int_equal(gscl_fit_step(&fit, 1e-6f, 1), GSCL_OK);
    assert_true(read_control(&fit).log_max == second);
    assert_int_equal(gscl_fit_step(&fit, 1e-6f, 1), GSCL_OK);
    assert_float_equal(read_control(&fit).log_max, second - gscl_fit_tunables.axis_reduction, 1e-5);
    gscl_fit_free(&fit);
}

/* Lists that are too short are found, and filled again with more room. */
static void test_lists_grow(void **unused) {
    (void)unused;
    static float error[2][PLANE];
    for (int is_short = 0; is_short < 2; is_short++) {
        gscl_fit fit = fit_of_a_ramp();
        append_splats(&fit);
        if (is_short) {
            fit.renderer.row_capacity = 1;
            fit.links.capacity = 1;
        }
        assert_int_equal(gscl_fit_error(&fit, error[is_short]), GSCL_OK);
        assert_true(fit.has_known_lengths && !fit.has_old_lists);
        assert_true(fit.renderer.row_capacity > SPLATS && fit.links.capacity > SPLATS);
        gscl_fit_free(&fit);
    }
    assert_memory_equal(error[0], error[1], sizeof error[0]);
}

/* Splats that are appended after most of the others were removed, or to none, have lists of their own. */
static void test_lists_of_few_splats(void **unused) {
    (void)unused;
    const size_t order[] = {3};
    for (size_t kept = 0; kept < 2; kept++) {
        gscl_fit fit = fit_of_a_ramp();
        append_splats(&fit);
        assert_int_equal(gscl_fit_bin(&fit, true), GSCL_OK);
        assert_int_equal(gscl_fit_reorder(&fit, order, kept), GSCL_OK);
        if (kept == 0)
            assert_int_equal(gscl_fit_bin(&fit, true), GSCL_OK);
        for (int i = 0; i < 2; i++) {
            const float params[GSCL_PARAMS] = {20, 20, 1, 1};
            assert_int_equal(gscl_fit_append(&fit, params, 1), GSCL_OK);
            assert_true(fit.links.capacity < 100000);
        }
        assert_int_equal(gscl_fit_step(&fit, 1.0f, 1), GSCL_OK);
        assert_int_equal(fit.renderer.count, kept + 2);
        gscl_fit_free(&fit);
    }
}

/* The sums of a large image, whose last work-group has fewer pixels, against double precision. */
static void test_sums_of_errors(void **unused) {
    (void)unused;
    enum { SIDE = 1100, PIXELS = SIDE * SIDE };
    const gscl_kernel_options options = {.blend = GSCL_NORMALIZED, .colours = 1};
    float *large = malloc(2 * PIXELS * sizeof *large), *other = large + PIXELS;
    gscl_fit fit;
    gscl_buffer drawn = {0};
    double sum = 0, mse[2], distortion;
    assert_non_null(large);
    for (int i = 0; i < PIXELS; i++) {
        large[i] = (float)(i % 251) / 251.0f;
        other[i] = (float)(i % 241) / 241.0f;
        sum += ((double)large[i] - other[i]) * ((double)large[i] - other[i]);
    }
    assert_int_equal(gscl_fit_create(&fit, context, &options, SIDE, SIDE, 0, large), GSCL_OK);
    assert_int_equal(gscl_buffer_upload_async(context, &drawn, other, PIXELS * sizeof *other), GSCL_OK);
    for (int i = 0; i < 2; i++)
        assert_int_equal(gscl_fit_mse_against_source(&fit, &drawn, &mse[i]), GSCL_OK);
    assert_true(fabs(mse[0] * PIXELS / sum - 1) < 1e-6);
    assert_true(mse[0] == mse[1]);
    assert_int_equal(gscl_fit_distortion(&fit, &drawn, &distortion), GSCL_OK);
    assert_true(mse[0] == (double)(distortion / PIXELS));
    gscl_buffer_free(&drawn);
    gscl_fit_free(&fit);
    free(large);
}

/* Data may be released once they are staged, whether or not the copy before has ended. */
static void test_staged_copies(void **unused) {
    (void)unused;
    enum { COUNT = 4096 };
    static float data[COUNT], found[2 * COUNT];
    gscl_buffer buffer = {0};
    gscl_staging staging = {0};
    assert_int_equal(gscl_buffer_reserve(context, &buffer, sizeof found), GSCL_OK);
    for (size_t part = 0; part < 2; part++) {
        for (size_t i = 0; i < COUNT; i++)
            data[i] = (float)(part * COUNT + i);
        assert_int_equal(gscl_buffer_write_staged(context, &staging, &buffer, part * sizeof data, data, sizeof data),
                         GSCL_OK);
    }
    memset(data, 0, sizeof data);
    assert_int_equal(gscl_buffer_read(context, &buffer, 0, found, sizeof found), GSCL_OK);
    for (size_t i = 0; i < 2 * COUNT; i++)
        assert_true(found[i] == (float)i);
    gscl_staging_free(context, &staging);
    gscl_buffer_free(&buffer);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_levels_end_at_the_smallest_side),
        cmocka_unit_test(test_levels_are_means_of_pixels),
        cmocka_unit_test(test_levels_are_clamped),
        cmocka_unit_test(test_released_scratch_comes_back),
        cmocka_unit_test(test_weights_begin_at_zero),
        cmocka_unit_test(test_reordering_keeps_the_optimiser),
        cmocka_unit_test(test_fixed_splats_stay),
        cmocka_unit_test(test_new_splats_end_skipping),
        cmocka_unit_test(test_steps_do_not_wait),
        cmocka_unit_test(test_long_lists_bound_axes),
        cmocka_unit_test(test_lists_grow),
        cmocka_unit_test(test_lists_of_few_splats),
        cmocka_unit_test(test_sums_of_errors),
        cmocka_unit_test(test_staged_copies),
    };
    return cmocka_run_group_tests(tests, open_context, close_context);
}
