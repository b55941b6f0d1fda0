/* What the device follows of a fit (cl/sums.cl), in both mappings: by a single work-group and, where there are many tiles or
 * splats, by several before it. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include <gscl/gscl.h>

#include "both_mappings.h"
#include "cl/constants.h"
#include "fit/fit.h"
#include "fit/random.h"
#include "fit/tunables.h"

/* Pixels of a side and splats: few and many tiles, with few and many splats; no number of them is one of whole parts. */
static const uint32_t cases[][2] = {{100, 70}, {1040, 70}, {100, 5000}};
#define MAX_SIDE 1040
#define MAX_SPLATS 5000
#define MAX_TILES (65 * 65)

static float planes[MAX_SIDE * MAX_SIDE], params[MAX_SPLATS * GSCL_PARAMS], bounds[MAX_SPLATS * GSCL_BOUNDS];
static float losses[MAX_TILES];
static int32_t row_totals[MAX_SIDE];

static gscl_fit fit_of(gscl_context *context, uint32_t side, uint32_t splats) {
    const gscl_kernel_options options = {.blend = GSCL_NORMALIZED, .colours = 1};
    uint64_t random = 7;
    gscl_fit fit;
    for (uint32_t i = 0; i < splats; i++) {
        float *p = params + (size_t)i * GSCL_PARAMS;
        p[GSCL_X] = gscl_random_unit(&random) * (float)side;
        p[GSCL_Y] = gscl_random_unit(&random) * (float)side;
        p[GSCL_LOG_S1] = p[GSCL_LOG_S2] = i % 3 == 0 ? -0.6f : 1.0f; /* a third is low */
    }
    assert_int_equal(gscl_fit_create(&fit, context, &options, side, side, 0, planes), GSCL_OK);
    assert_int_equal(gscl_fit_append(&fit, params, splats), GSCL_OK);
    assert_int_equal(gscl_buffer_read(context, &fit.renderer.ellipse_bounds, 0, bounds,
                                      (size_t)splats * GSCL_BOUNDS * sizeof *bounds),
                     GSCL_OK);
    return fit;
}

/* Writes losses of all tiles; returns their sum. */
static double write_losses(gscl_fit *fit) {
    const size_t tiles = gscl_renderer_tiles(&fit->renderer);
    uint64_t random = 3;
    double sum = 0;
    for (size_t i = 0; i < tiles; i++)
        sum += losses[i] = gscl_random_unit(&random);
    assert_int_equal(gscl_buffer_write(fit->context, &fit->tile_loss, 0, losses, tiles * sizeof *losses), GSCL_OK);
    return sum;
}

/* As many entries of lists in each row of tiles. */
static void write_entries(gscl_fit *fit, int32_t entries) {
    const size_t rows = (size_t)fit->renderer.view.tiles_y;
    for (size_t i = 0; i < rows; i++)
        row_totals[i] = entries;
    assert_int_equal(
        gscl_buffer_write(fit->context, &fit->renderer.row_totals, 0, row_totals, rows * sizeof *row_totals), GSCL_OK);
}

static gscl_fit_control read_control(const gscl_fit *fit) {
    gscl_fit_control control;
    assert_int_equal(gscl_buffer_read(fit->context, &fit->control, 0, &control, sizeof control), GSCL_OK);
    return control;
}

static int low_splats(const gscl_fit *fit) {
    const float low = gscl_fit_tunables.low_axis * sqrtf(2.0f * GSCL_SUPPORT);
    int count = 0;
    for (int i = 0; i < fit->renderer.count; i++)
        count += bounds[i * GSCL_BOUNDS + GSCL_BOUNDS_HALF_HEIGHT] < low;
    assert_in_range(count, fit->renderer.count / 4, fit->renderer.count / 2);
    return count;
}

static void check_control(gscl_context *context, uint32_t side, uint32_t splats) {
    gscl_fit fit = fit_of(context, side, splats);
    const double loss = write_losses(&fit) / ((double)side * side);
    const float log_max = read_control(&fit).log_max;
    assert_int_equal(gscl_fit_sum_loss(&fit), GSCL_OK);
    gscl_fit_control control = read_control(&fit);
    assert_float_equal(control.loss, loss, 1e-6 * loss);
    assert_true(control.skip_threshold == 0);
    write_losses(&fit);
    write_entries(&fit, 0);
    assert_int_equal(gscl_fit_follow(&fit, false), GSCL_OK);
    assert_true(read_control(&fit).skip_threshold == 0);
    assert_int_equal(gscl_fit_follow(&fit, true), GSCL_OK);
    control = read_control(&fit);
    assert_float_equal(control.loss, loss, 1e-6 * loss);
    assert_true(control.skip_threshold > 0);
    assert_float_equal(control.low_splats * (float)splats, low_splats(&fit), 1e-3);
    assert_true(control.log_max == log_max);
    write_entries(&fit, 100000);
    assert_int_equal(gscl_fit_follow(&fit, true), GSCL_OK);
    assert_true(read_control(&fit).log_max < log_max);
    gscl_fit_free(&fit);
}

static void test_the_device_follows_the_fit(void **state) {
    (void)state;
    for (int m = 0; m < mapping_count; m++)
        for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
            check_control(contexts[m], cases[i][0], cases[i][1]);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_the_device_follows_the_fit)};
    return cmocka_run_group_tests(tests, open_contexts, close_contexts);
}
