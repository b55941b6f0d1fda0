/* The pool of a search: the best rectangle of cells, and images that are combined of two. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cl/constants.h"
#include "decode/quantise.h"
#include "scalar/scalar_fit.h"
#include "scalar/search_pool.h"
#define TESTS_KERNELS
#include "one_context.h"
#include "synthetic_scene.h"

#define CELLS GSCL_SEARCH_CELLS
#define SIDE 64 /* pixels */
#define ROW 4   /* splats side by side, in as many rows */
#define ROUNDING 1e-9

/* ---- The best rectangle ---- */

static double sum_of(gscl_search_cells gain, const gscl_search_part *part) {
    double sum = 0;
    for (int y = part->y0; y < part->y1; y++)
        for (int x = part->x0; x < part->x1; x++)
            sum += gain[y][x];
    return sum;
}

/* The largest sum of all rectangles; 0 where none is positive. */
static double largest_sum(gscl_search_cells gain) {
    double largest = 0;
    for (int y0 = 0; y0 < CELLS; y0++)
        for (int y1 = y0 + 1; y1 <= CELLS; y1++)
            for (int x0 = 0; x0 < CELLS; x0++)
                for (int x1 = x0 + 1; x1 <= CELLS; x1++)
                    largest = fmax(largest, sum_of(gain, &(gscl_search_part){.x0 = x0, .x1 = x1, .y0 = y0, .y1 = y1}));
    return largest;
}

static void test_best_part_of_random_gains(void **state) {
    (void)state;
    gscl_search_cells gain;
    synthetic_random_state = 3;
    for (int trial = 0; trial < 20; trial++) {
        const double mean = -0.9 + 0.08 * trial; /* of the last ones nearly all cells belong to the best part */
        for (int i = 0; i < CELLS * CELLS; i++)
            gain[i / CELLS][i % CELLS] = (double)synthetic_uniform(-1, 1) + mean;
        const gscl_search_part best = gscl_search_best_part(gain);
        assert_true(fabs(best.gain - largest_sum(gain)) < ROUNDING);
        assert_true(fabs(best.gain - sum_of(gain, &best)) < ROUNDING);
    }
}

static void test_no_part_without_gain(void **state) {
    (void)state;
    gscl_search_cells gain = {{0}};
    assert_true(gscl_search_best_part(gain).gain <= 0);
    for (int i = 0; i < CELLS * CELLS; i++)
        gain[i / CELLS][i % CELLS] = -1;
    assert_true(gscl_search_best_part(gain).gain <= 0);
    gain[CELLS - 1][CELLS - 1] = 1;
    const gscl_search_part corner = gscl_search_best_part(gain);
    assert_true(corner.x0 == CELLS - 1 && corner.x1 == CELLS && corner.y0 == CELLS - 1 && corner.y1 == CELLS);
}

/* ---- Combinations ---- */

typedef struct {
    gscl_encoder encoder;
    gscl_coded_image coded;
    gscl_scalar_state state;
    gscl_search_pool pool;
} scene;

/* The image: brighter from left to right. */
static void open_scene(scene *s) {
    static float planes[3 * SIDE * SIDE];
    memset(s, 0, sizeof *s);
    s->encoder.context = context;
    s->coded.file.header = (gsf_header){.blend = GSF_BLEND_NORMALIZED,
                                        .coding = GSF_CODING_SCALAR,
                                        .layout = GSF_RGB,
                                        .has_chroma = true,
                                        .has_rotation = true,
                                        .has_anisotropy = true,
                                        .width = SIDE,
                                        .height = SIDE};
    s->coded.file.steps = gsf_default_steps(ROW * ROW);
    for (int i = 0; i < 3 * SIDE * SIDE; i++)
        planes[i] = 0.2f + 0.6f * (float)(i % SIDE) / SIDE;
    const gscl_kernel_options options = gscl_coded_image_options(&s->coded.file.header);
    s->state = (gscl_scalar_state){.encoder = &s->encoder, .coded = &s->coded};
    assert_int_equal(gscl_fit_create(&s->state.fit, context, &options, SIDE, SIDE, 0, planes), GSCL_OK);
}

static void close_scene(scene *s) {
    gscl_search_pool_free(&s->pool);
    gscl_fit_free(&s->state.fit);
    gscl_coded_image_free(&s->coded);
    free(s->state.params);
}

/* A grid of splats, which are as bright as the image from x0 to before x1, and black elsewhere.  Returns the error. */
static double code_grid(scene *s, double x0, double x1) {
    double error;
    assert_int_equal(gscl_coded_image_reserve(&s->coded, ROW * ROW), GSCL_OK);
    s->coded.file.header.splat_count = ROW * ROW;
    for (int i = 0; i < ROW * ROW; i++) {
        const float x = ((float)(i % ROW) + 0.5f) * SIDE / ROW, y = ((float)(i / ROW) + 0.5f) * SIDE / ROW;
        float p[GSCL_PARAMS] = {[GSCL_X] = x, [GSCL_Y] = y, [GSCL_LOG_S1] = 1.9f, [GSCL_LOG_S2] = 1.9f};
        for (int k = 0; k < 3; k++)
            p[GSCL_COLOUR + k] = (double)x >= x0 && (double)x < x1 ? 0.2f + 0.6f * x / SIDE : 0.0f;
        gscl_quantise(&s->coded.file, p, &s->coded.file.splats[i]);
    }
    assert_int_equal(gscl_scalar_measure(&s->state, &error), GSCL_OK);
    return error;
}

static double error_of(scene *s) {
    double error;
    assert_int_equal(gscl_scalar_measure(&s->state, &error), GSCL_OK);
    return error;
}

/* An image that is right on the left side takes the right side of one that is right there, and is right as a whole. */
static void test_halves_are_combined(void **state) {
    (void)state;
    scene s;
    bool is_combined;
    open_scene(&s);
    const double whole = code_grid(&s, 0, SIDE);
    const double right = code_grid(&s, SIDE / 2, SIDE);
    assert_int_equal(gscl_search_pool_add(&s.pool, &s.state, right), GSCL_OK);
    const double left = code_grid(&s, 0, SIDE / 2);
    assert_true(left > 10 * whole && right > 10 * whole);
    assert_int_equal(gscl_search_pool_combine(&s.pool, &s.state, &is_combined), GSCL_OK);
    assert_true(is_combined);
    assert_int_equal(s.coded.file.header.splat_count, ROW * ROW);
    assert_true(fabs(error_of(&s) - whole) <= 1e-6 * whole);
    close_scene(&s);
}

/* A part that has been taken is worth less: some time later one of another member is taken. */
static void test_parts_are_taken_in_turn(void **state) {
    (void)state;
    scene s;
    open_scene(&s);
    const double narrow = code_grid(&s, 0, 0.75 * SIDE);
    assert_int_equal(gscl_search_pool_add(&s.pool, &s.state, narrow), GSCL_OK);
    assert_int_equal(gscl_search_pool_add(&s.pool, &s.state, code_grid(&s, 0, SIDE)), GSCL_OK);
    int taken = 0; /* so often the better part */
    for (bool is_better = true; is_better && taken < 10;) {
        bool is_combined;
        code_grid(&s, 0, SIDE / 2);
        assert_int_equal(gscl_search_pool_combine(&s.pool, &s.state, &is_combined), GSCL_OK);
        assert_true(is_combined);
        is_better = error_of(&s) < 0.5 * narrow;
        taken += is_better;
    }
    assert_true(taken > 0 && taken < 10);
    assert_true(fabs(error_of(&s) - narrow) <= 1e-6 * narrow);
    close_scene(&s);
}

static void test_equal_images_are_not_combined(void **state) {
    (void)state;
    scene s;
    bool is_combined;
    open_scene(&s);
    const double error = code_grid(&s, 0, SIDE / 2);
    assert_int_equal(gscl_search_pool_combine(&s.pool, &s.state, &is_combined), GSCL_OK);
    assert_false(is_combined); /* the pool is empty */
    assert_int_equal(gscl_search_pool_add(&s.pool, &s.state, error), GSCL_OK);
    assert_int_equal(gscl_search_pool_combine(&s.pool, &s.state, &is_combined), GSCL_OK);
    assert_false(is_combined);
    assert_true(fabs(error_of(&s) - error) <= 0);
    close_scene(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_best_part_of_random_gains),     cmocka_unit_test(test_no_part_without_gain),
        cmocka_unit_test(test_halves_are_combined),           cmocka_unit_test(test_parts_are_taken_in_turn),
        cmocka_unit_test(test_equal_images_are_not_combined),
    };
    return cmocka_run_group_tests(tests, open_context, close_context);
}
