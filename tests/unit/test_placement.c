/* Placement of new splats on the device: samples that keep apart, splats along edges, and all of it beside the same in double
 * precision (fit/placement.h, fit/density.h). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cl/constants.h"
#include "fit/density.h"
#include "fit/placement.h"
#include "fit/random.h"
#include "fit/tunables.h"
#include "image/flat_background.h"
#define TESTS_KERNELS
#include "one_context.h"

#define WIDTH 70 /* not a multiple of a strip, or of what a work-item sums */
#define HEIGHT 45
#define PIXELS (WIDTH * HEIGHT)
#define SPLATS 35 /* one for each 9 x 10 pixels */

typedef float painter(int x, int y);

/* A fit of a painted grey image, at its finest level. */
static void begin_fit(painter *paint, int shape, gscl_fit *fit) {
    static float planes[PIXELS];
    for (int i = 0; i < PIXELS; i++)
        planes[i] = paint(i % WIDTH, i / WIDTH);
    const gscl_kernel_options options = {.blend = GSCL_NORMALIZED, .colours = 1, .shape = shape};
    assert_int_equal(gscl_fit_create(fit, context, &options, WIDTH, HEIGHT, 0, planes), GSCL_OK);
}

/* Writes a density and its sum. */
static void set_density(gscl_fit *fit, const float *density, float total) {
    assert_int_equal(gscl_buffer_reserve(context, &fit->error, PIXELS * sizeof *density), GSCL_OK);
    assert_int_equal(gscl_buffer_reserve(context, &fit->density_total, sizeof total), GSCL_OK);
    assert_int_equal(gscl_buffer_write(context, &fit->error, 0, density, PIXELS * sizeof *density), GSCL_OK);
    assert_int_equal(gscl_buffer_write(context, &fit->density_total, 0, &total, sizeof total), GSCL_OK);
}

/* Settings for `count` splats with a sigma of 3 pixels. */
static gscl_placement_settings settings_for(const gscl_fit *fit, size_t count) {
    gscl_placement_settings settings = gscl_placement_begin(fit, count);
    settings.density_scale = 1.0f;
    settings.axis = 3.0f;
    settings.least_distance = settings.most_distance = 1.0f;
    return settings;
}

/* Places SPLATS splats and reads them. */
static void place(gscl_fit *fit, uint64_t *random, float params[SPLATS][GSCL_PARAMS]) {
    fit->renderer.count = 0;
    assert_int_equal(gscl_placement_append(fit, settings_for(fit, SPLATS), random), GSCL_OK);
    assert_int_equal(gscl_fit_read(fit, params[0]), GSCL_OK);
}

static float slope(int x, int y) {
    return 0.005f * (float)(x + y);
}

/* No two samples of an even density are close, and each pixel can be sampled. */
static void test_samples_keep_apart(void **unused) {
    (void)unused;
    static float density[PIXELS], params[SPLATS][GSCL_PARAMS];
    gscl_fit fit;
    uint64_t random = 5;
    bool is_hit[PIXELS] = {false};
    int close = 0, missed = 0;
    begin_fit(slope, GSCL_SHAPE_ROTATED, &fit);
    for (int i = 0; i < PIXELS; i++)
        density[i] = 1.0f;
    set_density(&fit, density, PIXELS);
    for (int round = 0; round < 1000; round++) {
        place(&fit, &random, params);
        for (size_t i = 0; i < SPLATS; i++) {
            const int at_x = (int)params[i][GSCL_X], at_y = (int)params[i][GSCL_Y];
            assert_in_range(at_x, 0, WIDTH - 1);
            assert_in_range(at_y, 0, HEIGHT - 1);
            is_hit[at_y * WIDTH + at_x] = true;
            for (size_t j = 0; j < i; j++) {
                const int x = at_x - (int)params[j][GSCL_X], y = at_y - (int)params[j][GSCL_Y];
                close += x * x + y * y <= 9;
            }
        }
    }
    for (int i = 0; i < PIXELS; i++)
        missed += !is_hit[i];
    assert_int_equal(missed, 0);
    /* Of independent samples 1000 * 35 * 34 / 2 * 29 / 3150 = 5500 pairs would be. */
    assert_true(close < 1500);
    gscl_fit_free(&fit);
}

/* Each sample stands for the same share of the density. */
static void test_samples_follow_the_density(void **unused) {
    (void)unused;
    static float density[PIXELS], params[SPLATS][GSCL_PARAMS];
    gscl_fit fit;
    uint64_t random = 5;
    int left = 0;
    begin_fit(slope, GSCL_SHAPE_ISOTROPIC, &fit);
    for (int i = 0; i < PIXELS; i++)
        density[i] = i % WIDTH < WIDTH / 2 ? 4.0f : 1.0f;
    set_density(&fit, density, 2.5f * PIXELS);
    for (int round = 0; round < 100; round++) {
        place(&fit, &random, params);
        for (size_t i = 0; i < SPLATS; i++)
            left += params[i][GSCL_X] < WIDTH / 2;
    }
    assert_true(abs(left - 100 * SPLATS * 4 / 5) < 50);
    /* Their sizes are as many pixels a sample as the square of the distance says. */
    gscl_placement_settings settings = settings_for(&fit, SPLATS);
    settings.first = fit.renderer.count = 0;
    settings.axis = 1.0f;
    settings.least_distance = 0.0f;
    settings.most_distance = WIDTH;
    assert_int_equal(gscl_placement_append(&fit, settings, &random), GSCL_OK);
    assert_int_equal(gscl_fit_read(&fit, params[0]), GSCL_OK);
    for (size_t i = 0; i < SPLATS; i++) {
        const double share = params[i][GSCL_X] < WIDTH / 2 ? 4 : 1;
        assert_float_equal(exp(params[i][GSCL_LOG_S1]), sqrt(2.5 * PIXELS / SPLATS / share), 1e-3);
    }
    gscl_fit_free(&fit);
}

/* Splats stay in the image whatever the density is, and spread where it is 0 everywhere. */
static void test_densities_of_nothing(void **unused) {
    (void)unused;
    static float density[PIXELS], params[SPLATS][GSCL_PARAMS];
    const float cases[] = {0.0f, NAN, INFINITY};
    gscl_fit fit;
    uint64_t random = 5;
    begin_fit(slope, GSCL_SHAPE_ROTATED, &fit);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        for (int i = 0; i < PIXELS; i++)
            density[i] = cases[k];
        set_density(&fit, density, cases[k]);
        place(&fit, &random, params);
        for (size_t i = 0; i < SPLATS; i++) {
            assert_true(params[i][GSCL_X] >= 0 && params[i][GSCL_X] <= WIDTH);
            assert_true(params[i][GSCL_Y] >= 0 && params[i][GSCL_Y] <= HEIGHT);
            assert_true(isfinite(params[i][GSCL_LOG_S1]));
        }
        if (k == 0)
            assert_true(params[SPLATS - 1][GSCL_Y] > HEIGHT / 2);
    }
    gscl_fit_free(&fit);
}

static float falling_edge(int x, int y) {
    return fminf(fmaxf(0.5f + 0.1f * (float)(2 * x + y - WIDTH), 0.2f), 0.8f);
}
static float flat(int x, int y) {
    (void)x, (void)y;
    return 0.5f;
}

/* A splat where all density is at one pixel. */
static void splat_at(painter *paint, int shape, int x, int y, float *params) {
    static float density[PIXELS], all[SPLATS][GSCL_PARAMS];
    gscl_fit fit;
    uint64_t random = 5;
    memset(density, 0, sizeof density);
    density[y * WIDTH + x] = 0.25f;
    begin_fit(paint, shape, &fit);
    set_density(&fit, density, 0.25f);
    place(&fit, &random, all);
    for (size_t i = 0; i < SPLATS; i++) {
        assert_true(all[i][GSCL_X] >= (float)x && all[i][GSCL_X] <= (float)(x + 1));
        assert_true(all[i][GSCL_Y] >= (float)y && all[i][GSCL_Y] <= (float)(y + 1));
        assert_float_equal(all[i][GSCL_COLOUR], paint(x, y), 1e-6);
    }
    memcpy(params, all[0], sizeof all[0]);
    gscl_fit_free(&fit);
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

/* ---- The same in double precision ---- */

static int clamp(int i, int count) {
    return i < 0 ? 0 : i < count ? i : count - 1;
}

static double edge_strength(const float *plane, int x, int y) {
    const double by_x = plane[y * WIDTH + clamp(x + 1, WIDTH)] - (double)plane[y * WIDTH + clamp(x - 1, WIDTH)];
    const double by_y = plane[clamp(y + 1, HEIGHT) * WIDTH + x] - (double)plane[clamp(y - 1, HEIGHT) * WIDTH + x];
    return sqrt(by_x * by_x + by_y * by_y);
}

static void box_sum(const double *from, int radius, double *to) {
    for (int i = 0; i < PIXELS; i++) {
        to[i] = 0;
        for (int y = i / WIDTH - radius; y <= i / WIDTH + radius; y++)
            for (int x = i % WIDTH - radius; x <= i % WIDTH + radius; x++)
                if (x >= 0 && y >= 0 && x < WIDTH && y < HEIGHT)
                    to[i] += from[y * WIDTH + x];
    }
}

/* The pixels on the walk through strips of height `strip`, in its order. */
static void walk(int strip, int *pixels) {
    for (int top = 0; top < HEIGHT; top += strip)
        for (int column = 0; column < WIDTH; column++)
            for (int y = top; y < top + strip && y < HEIGHT; y++)
                *pixels++ = y * WIDTH + (top / strip % 2 ? WIDTH - 1 - column : column);
}

/* The pixels and points of samples of a density, and the distances between samples there. */
static void sample(const double *density, size_t count, uint64_t *random, double (*samples)[3]) {
    static int order[PIXELS];
    double total = 0;
    walk((int)sqrt((double)PIXELS / (double)count) + 1, order);
    for (int i = 0; i < PIXELS; i++)
        total += density[i];
    for (size_t i = 0; i < count; i++) {
        const double value = ((double)i + gscl_random_unit(random)) / (double)count * total;
        double sum = density[order[0]];
        int at = 0;
        while (sum <= value && at < PIXELS - 1)
            sum += density[order[++at]];
        samples[i][0] = order[at] % WIDTH + (double)gscl_random_unit(random);
        samples[i][1] = order[at] / WIDTH + (double)gscl_random_unit(random);
        samples[i][2] = sqrt(total / (density[order[at]] * (double)count));
    }
}

/* Compares the splats from `first` on with samples, and their sigma with `axis` times the distance within bounds. */
static void compare_splats(gscl_fit *fit, size_t first, size_t count, double (*samples)[3], double axis, double least,
                           double most) {
    float *params = malloc((first + count) * GSCL_PARAMS * sizeof *params);
    assert_non_null(params);
    assert_int_equal(fit->renderer.count, first + count);
    assert_int_equal(gscl_fit_read(fit, params), GSCL_OK);
    for (size_t i = 0; i < count; i++) {
        const float *p = params + (first + i) * GSCL_PARAMS;
        const double sigma = axis * fmin(fmax(samples[i][2], least), most);
        assert_float_equal(p[GSCL_X], samples[i][0], 1e-4);
        assert_float_equal(p[GSCL_Y], samples[i][1], 1e-4);
        assert_float_equal(p[GSCL_LOG_S1], log(fmax(sigma, gscl_fit_tunables.min_axis)), 1e-4);
    }
    free(params);
}

static float discs(int x, int y) {
    return hypotf((float)x - 20, (float)y - 15) < 9 ? 0.9f : hypotf((float)x - 52, (float)y - 30) < 6 ? 0.1f : 0.4f;
}

/* Makes the fit of `discs` with their flat background. */
static void begin_discs(gscl_fit *fit, float *plane) {
    gscl_flat_background background;
    begin_fit(discs, GSCL_SHAPE_ISOTROPIC, fit);
    for (int i = 0; i < PIXELS; i++)
        plane[i] = discs(i % WIDTH, i / WIDTH);
    assert_true(gscl_find_flat_background(plane, WIDTH, HEIGHT, 1, &background));
    assert_true(background.pixels > 0);
    assert_int_equal(gscl_fit_set_flat_background(fit, &background), GSCL_OK);
}

static double area_of(const gscl_fit *fit) {
    return (1 - fit->flat.pixels) * PIXELS;
}

/* The first splats follow edges and leave out the flat background away from them. */
static void test_seeds_are_those_of_double_precision(void **unused) {
    (void)unused;
    static float plane[PIXELS];
    static double strength[PIXELS], edges[PIXELS], near_edges[PIXELS], density[PIXELS], samples[200][3];
    const struct gscl_fit_tunables *t = &gscl_fit_tunables;
    const size_t counts[] = {1, 18, 200};
    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
        const size_t count = counts[k];
        gscl_fit fit;
        double total = 0;
        uint64_t random = 7, oracle_random = 7;
        begin_discs(&fit, plane);
        for (int i = 0; i < PIXELS; i++) {
            strength[i] = edge_strength(plane, i % WIDTH, i / WIDTH);
            edges[i] = strength[i] > 0;
        }
        box_sum(edges, (int)(t->background_distance * sqrt(area_of(&fit) / (double)count)) + 1, near_edges);
        for (int i = 0; i < PIXELS; i++)
            total += strength[i];
        for (int i = 0; i < PIXELS; i++)
            density[i] = strength[i] / total + (near_edges[i] > 0 || plane[i] != plane[0] ? 1.0 / PIXELS : 0);
        sample(density, count, &oracle_random, samples);
        assert_int_equal(gscl_density_seed(&fit, count, &random), GSCL_OK);
        compare_splats(&fit, 0, count, samples, t->seed_axis, 0, WIDTH + HEIGHT);
        assert_true(random == oracle_random);
        gscl_fit_free(&fit);
    }
}

/* Later splats follow the error. */
static void test_new_splats_are_those_of_double_precision(void **unused) {
    (void)unused;
    static float plane[PIXELS], error[PIXELS];
    static double exact[PIXELS], density[PIXELS], samples[60][3];
    const struct gscl_fit_tunables *t = &gscl_fit_tunables;
    const size_t first = 20, counts[] = {1, 7, 60};
    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
        const size_t count = counts[k];
        uint64_t random = 7, oracle_random;
        gscl_fit fit;
        begin_discs(&fit, plane);
        assert_int_equal(gscl_density_seed(&fit, first, &random), GSCL_OK);
        assert_int_equal(gscl_fit_error(&fit, error), GSCL_OK);
        for (int i = 0; i < PIXELS; i++)
            exact[i] = error[i];
        const double distance = sqrt(area_of(&fit) / (double)(first + count)),
                     mean = sqrt(area_of(&fit) / (double)count);
        box_sum(exact, (int)(t->error_radius * distance) + 1, density);
        oracle_random = random;
        sample(density, count, &oracle_random, samples);
        assert_int_equal(gscl_density_grow(&fit, count, &random), GSCL_OK);
        compare_splats(&fit, first, count, samples, t->new_axis * distance / mean, mean, t->max_spread * mean);
        assert_true(random == oracle_random);
        gscl_fit_free(&fit);
    }
}

/* Sums of more columns than one work-group adds up. */
static void test_samples_of_many_columns(void **unused) {
    (void)unused;
    enum { TALL = 3000, NARROW = 40, COUNT = 2000 };
    static float planes[TALL * NARROW], params[COUNT][GSCL_PARAMS];
    const gscl_kernel_options options = {.blend = GSCL_NORMALIZED, .colours = 1, .shape = GSCL_SHAPE_ISOTROPIC};
    gscl_fit fit;
    uint64_t random = 5;
    for (int i = 0; i < TALL * NARROW; i++)
        planes[i] = 0.5f * (float)(i / NARROW / 2 % 2); /* the same strength of edges everywhere but at the ends */
    assert_int_equal(gscl_fit_create(&fit, context, &options, NARROW, TALL, 0, planes), GSCL_OK);
    assert_int_equal(gscl_density_seed(&fit, COUNT, &random), GSCL_OK);
    assert_int_equal(gscl_fit_read(&fit, params[0]), GSCL_OK);
    for (int i = 0; i < COUNT; i++) /* one after another, in strips of 8 rows */
        assert_float_equal(params[i][GSCL_Y], (double)i * TALL / COUNT, 9);
    gscl_fit_free(&fit);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_samples_keep_apart),
        cmocka_unit_test(test_samples_follow_the_density),
        cmocka_unit_test(test_densities_of_nothing),
        cmocka_unit_test(test_splats_lie_along_edges),
        cmocka_unit_test(test_splats_are_circles_elsewhere),
        cmocka_unit_test(test_seeds_are_those_of_double_precision),
        cmocka_unit_test(test_new_splats_are_those_of_double_precision),
        cmocka_unit_test(test_samples_of_many_columns),
    };
    return cmocka_run_group_tests(tests, open_context, close_context);
}
