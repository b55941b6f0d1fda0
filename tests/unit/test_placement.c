/* Placement of new splats: samples that keep apart, and splats along edges (fit/placement.h). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "cl/constants.h"
#include "fit/placement.h"
#include "fit/tunables.h"
#include "one_context.h"

#define WIDTH 70 /* not a multiple of a strip */
#define HEIGHT 45
#define PIXELS (WIDTH * HEIGHT)
#define SPLATS 35 /* one for each 9 x 10 pixels */

typedef float painter(int x, int y);

/* A placement on the finest level of a painted grey image, with a density of 1. */
static void place_on(painter *paint, int shape, gscl_fit *fit, gscl_placement *placement) {
    static float planes[PIXELS];
    for (int i = 0; i < PIXELS; i++)
        planes[i] = paint(i % WIDTH, i / WIDTH);
    const gscl_kernel_options options = {.blend = GSCL_NORMALIZED, .colours = 1, .shape = shape};
    assert_int_equal(gscl_fit_create(fit, context, &options, WIDTH, HEIGHT, 0, planes), GSCL_OK);
    assert_int_equal(gscl_placement_create(placement, fit, SPLATS, true), GSCL_OK);
    for (int i = 0; i < PIXELS; i++)
        placement->density[i] = 1.0f;
    gscl_placement_accumulate(placement);
    assert_int_equal(gscl_placement_read_target(placement, fit, 0), GSCL_OK);
}

static void end_placement(gscl_fit *fit, gscl_placement *placement) {
    gscl_placement_free(placement);
    gscl_fit_free(fit);
}

static float slope(int x, int y) {
    return 0.005f * (float)(x + y);
}

/* No two samples of an even density are close, and each pixel can be sampled. */
static void test_samples_keep_apart(void **unused) {
    (void)unused;
    gscl_fit fit;
    gscl_placement p;
    uint64_t random = 5;
    bool is_hit[PIXELS] = {false};
    int close = 0, missed = 0;
    place_on(slope, GSCL_SHAPE_ROTATED, &fit, &p);
    for (int round = 0; round < 1000; round++) {
        size_t samples[SPLATS];
        for (size_t i = 0; i < SPLATS; i++) {
            samples[i] = gscl_placement_sample(&p, i, &random);
            assert_true(samples[i] < PIXELS);
            is_hit[samples[i]] = true;
            for (size_t j = 0; j < i; j++) {
                int x = (int)(samples[i] % WIDTH) - (int)(samples[j] % WIDTH);
                int y = (int)(samples[i] / WIDTH) - (int)(samples[j] / WIDTH);
                close += x * x + y * y <= 9;
            }
        }
    }
    for (int i = 0; i < PIXELS; i++)
        missed += !is_hit[i];
    assert_int_equal(missed, 0);
    /* Of independent samples 1000 * 35 * 34 / 2 * 29 / 3150 = 5500 pairs would be. */
    assert_true(close < 1500);
    end_placement(&fit, &p);
}

/* Each sample stands for the same share of the density. */
static void test_samples_follow_the_density(void **unused) {
    (void)unused;
    gscl_fit fit;
    gscl_placement p;
    uint64_t random = 5;
    int left = 0;
    place_on(slope, GSCL_SHAPE_ROTATED, &fit, &p);
    for (int i = 0; i < PIXELS; i++)
        p.density[i] = i % WIDTH < WIDTH / 2 ? 4.0f : 1.0f;
    gscl_placement_accumulate(&p);
    for (int round = 0; round < 100; round++)
        for (size_t i = 0; i < SPLATS; i++)
            left += gscl_placement_sample(&p, i, &random) % WIDTH < WIDTH / 2;
    assert_true(abs(left - 100 * SPLATS * 4 / 5) < 50);
    /* As many pixels a sample as the square of the distance says. */
    assert_float_equal(gscl_placement_distance(&p, 0), sqrt(2.5 * PIXELS / SPLATS / 4), 1e-3);
    assert_float_equal(gscl_placement_distance(&p, WIDTH - 1), sqrt(2.5 * PIXELS / SPLATS), 1e-3);
    end_placement(&fit, &p);
}

static void test_density_of_nothing(void **unused) {
    (void)unused;
    gscl_fit fit;
    gscl_placement p;
    uint64_t random = 5;
    place_on(slope, GSCL_SHAPE_ROTATED, &fit, &p);
    for (int i = 0; i < PIXELS; i++)
        p.density[i] = 0;
    gscl_placement_accumulate(&p);
    assert_true(gscl_placement_sample(&p, 0, &random) < PIXELS);
    assert_true(isfinite(gscl_placement_distance(&p, 0)));
    end_placement(&fit, &p);
}

/* A tall image's target is read in bands, each of which holds whole strips and what edges there need. */
static void test_target_is_read_in_bands(void **unused) {
    (void)unused;
    enum { TALL = 40000, NARROW = 32 };
    float *planes = malloc(3 * (size_t)TALL * NARROW * sizeof *planes), params[GSCL_PARAMS];
    assert_non_null(planes);
    for (int i = 0; i < 3 * TALL * NARROW; i++)
        planes[i] = (float)(i % 977) / 977.0f;
    const gscl_kernel_options options = {.blend = GSCL_NORMALIZED, .colours = 3};
    gscl_fit fit;
    gscl_placement p;
    uint64_t random = 5;
    assert_int_equal(gscl_fit_create(&fit, context, &options, NARROW, TALL, 0, planes), GSCL_OK);
    assert_int_equal(gscl_placement_create(&p, &fit, 1000, false), GSCL_OK);
    assert_true(p.rows < TALL);
    for (int y = 0; y < TALL; y += 1999) {
        assert_int_equal(gscl_placement_read_target(&p, &fit, y), GSCL_OK);
        const size_t pixel = (size_t)y * NARROW + NARROW / 2;
        gscl_placement_splat(&p, pixel, 3.0f, 0.0f, &random, params);
        for (size_t k = 0; k < 3; k++)
            assert_float_equal(params[GSCL_COLOUR + k], planes[k * TALL * NARROW + pixel], 1e-6);
    }
    end_placement(&fit, &p);
    free(planes);
}

static float falling_edge(int x, int y) {
    return fminf(fmaxf(0.5f + 0.1f * (float)(2 * x + y - WIDTH), 0.2f), 0.8f);
}
static float flat(int x, int y) {
    (void)x, (void)y;
    return 0.5f;
}

static void splat_at(painter *paint, int shape, int x, int y, float *params) {
    gscl_fit fit;
    gscl_placement p;
    uint64_t random = 5;
    place_on(paint, shape, &fit, &p);
    gscl_placement_splat(&p, (size_t)(y * WIDTH + x), 3.0f, 0.0f, &random, params);
    assert_true(params[GSCL_X] >= (float)x && params[GSCL_X] <= (float)(x + 1));
    assert_true(params[GSCL_Y] >= (float)y && params[GSCL_Y] <= (float)(y + 1));
    assert_float_equal(params[GSCL_COLOUR], paint(x, y), 1e-6);
    end_placement(&fit, &p);
}

static void test_splats_lie_along_edges(void **unused) {
    (void)unused;
    float params[GSCL_PARAMS] = {0};
    splat_at(falling_edge, GSCL_SHAPE_ROTATED, 25, 20, params);
    double angle =
        fabs(remainder(params[GSCL_THETA] - atan2(2, -1), 3.14159265358979)); /* the edge falls by 2 rows a column */
    assert_true(angle < 0.1);
    assert_float_equal(params[GSCL_LOG_S1], logf(3.0f) + gscl_fit_tunables.edge_stretch, 0.05);
    assert_float_equal(params[GSCL_LOG_S2], logf(3.0f) - gscl_fit_tunables.edge_stretch, 0.05);
}

static void test_splats_are_circles_elsewhere(void **unused) {
    (void)unused;
    const struct {
        painter *paint;
        int shape;
    } cases[] = {
        {flat, GSCL_SHAPE_ROTATED}, {falling_edge, GSCL_SHAPE_AXIS_ALIGNED}, {falling_edge, GSCL_SHAPE_ISOTROPIC}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int corner = 0; corner < 2; corner++) {
            float params[GSCL_PARAMS] = {0};
            splat_at(cases[i].paint, cases[i].shape, corner * (WIDTH - 1), corner * (HEIGHT - 1), params);
            assert_float_equal(params[GSCL_LOG_S1], logf(3.0f), 1e-6);
            assert_float_equal(params[GSCL_LOG_S2], logf(3.0f), 1e-6);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_samples_keep_apart),     cmocka_unit_test(test_samples_follow_the_density),
        cmocka_unit_test(test_density_of_nothing),     cmocka_unit_test(test_target_is_read_in_bands),
        cmocka_unit_test(test_splats_lie_along_edges), cmocka_unit_test(test_splats_are_circles_elsewhere),
    };
    return cmocka_run_group_tests(tests, open_context, close_context);
}
