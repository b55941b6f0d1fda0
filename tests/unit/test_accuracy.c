/* Accuracy: the reference renderer against the oracle, each choice of the renderer, and the derivatives. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>
#include <gscl/measure.h>

#include "cl/constants.h"
#include "oracle.h"
#include "decode/coded_image.h"
#include "measure/reference.h"
#include "devices.h"
#include "synthetic_image.h"

#define WIDTH 90 /* not a multiple of a tile */
#define HEIGHT 70
#define BLENDS 3
#define MAX_ROWS 40

static gscl_context *contexts[2]; /* of both mappings, with timing */
static gscl_image image;

typedef struct {
    uint8_t *bytes;
    size_t size;
    double psnr;
} file;
static file files[BLENDS]; /* normalized, alpha, sum */

static file encode_with_blend(gscl_blend blend) {
    file f;
    gscl_encode_settings settings;
    gscl_encode_report report = {.struct_size = sizeof report};
    gscl_encode_settings_default(&settings);
    settings.blend = blend;
    settings.effort = 2;
    settings.target = GSCL_TARGET_BYTES;
    settings.target_value = blend == GSCL_BLEND_ALPHA ? 3000 : 500;
    settings.effects_off = blend == GSCL_BLEND_ALPHA ? GSCL_EFFECT_OPACITY : 0; /* opaque in places */
    assert_int_equal(gscl_encode(contexts[0], &image, &settings, &f.bytes, &f.size, &report), GSCL_OK);
    f.psnr = report.psnr;
    return f;
}

static int open_all(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        gscl_context_settings settings;
        gscl_context_settings_default(&settings);
        settings.device = first_opencl_device();
        settings.timing = true;
        settings.mapping = i ? GSCL_MAPPING_GPU : GSCL_MAPPING_CPU;
        if (gscl_context_create(&contexts[i], &settings) != GSCL_OK)
            return -1;
    }
    image = synthetic_image(SYNTHETIC_SHAPES, WIDTH, HEIGHT, 3, GSCL_SAMPLE_U8);
    for (int i = 0; i < BLENDS; i++)
        files[i] = encode_with_blend((gscl_blend)(GSCL_BLEND_NORMALIZED + i));
    return 0;
}

static int close_all(void **state) {
    (void)state;
    for (int i = 0; i < BLENDS; i++)
        gscl_free(files[i].bytes);
    synthetic_image_free(&image);
    gscl_context_free(&contexts[0]);
    gscl_context_free(&contexts[1]);
    return 0;
}

/* ---- The reference ---- */

static void draw_reference(const file *f, bool cut, double *planes) {
    static double weights[WIDTH * HEIGHT];
    gscl_coded_image coded;
    gscl_reference reference;
    float background[4];
    assert_int_equal(gscl_coded_image_read(&coded, f->bytes, f->size, false), GSCL_OK);
    const gscl_kernel_options options = gscl_coded_image_options(&coded.file.header);
    const size_t count = coded.file.header.splat_count;
    float *params = malloc(count * GSCL_PARAMS * sizeof *params);
    gscl_coded_image_params(&coded, params, background);
    assert_int_equal(gscl_reference_create(&reference, &options, params, count, background, cut), GSCL_OK);
    gscl_reference_draw(&reference, (gscl_rectangle){0, 0, WIDTH, HEIGHT}, planes, weights);
    gscl_reference_free(&reference);
    gscl_coded_image_free(&coded);
    free(params);
}

/* The bound allows for parameters in single precision, which the oracle does not have. */
static void test_reference_draws_what_the_oracle_draws(void **state) {
    (void)state;
    static double planes[3 * WIDTH * HEIGHT];
    for (int i = 0; i < BLENDS; i++) {
        oracle_image decoded;
        double largest = 0;
        draw_reference(&files[i], true, planes);
        assert_true(oracle_decode(files[i].bytes, files[i].size, &decoded));
        for (int k = 0; k < 3; k++)
            for (int at = 0; at < WIDTH * HEIGHT; at++)
                largest =
                    fmax(largest, fabs(fmin(fmax(planes[k * WIDTH * HEIGHT + at], 0), 1) - decoded.pixels[3 * at + k]));
        oracle_free(&decoded);
        assert_true(largest < 2e-5);
    }
}

/* A part equals the same pixels of the whole. */
static void test_reference_draws_parts(void **state) {
    (void)state;
    static double whole[3 * WIDTH * HEIGHT], part[3 * 20 * 10], weights[20 * 10];
    const gscl_rectangle where = {31, 17, 51, 27};
    for (int i = 0; i < BLENDS; i++) {
        gscl_coded_image coded;
        gscl_reference reference;
        float background[4], *params;
        draw_reference(&files[i], true, whole);
        assert_int_equal(gscl_coded_image_read(&coded, files[i].bytes, files[i].size, false), GSCL_OK);
        const gscl_kernel_options options = gscl_coded_image_options(&coded.file.header);
        params = malloc(coded.file.header.splat_count * GSCL_PARAMS * sizeof *params);
        gscl_coded_image_params(&coded, params, background);
        assert_int_equal(
            gscl_reference_create(&reference, &options, params, coded.file.header.splat_count, background, true),
            GSCL_OK);
        gscl_reference_draw(&reference, where, part, weights);
        for (int k = 0; k < 3; k++)
            for (int y = 0; y < 10; y++)
                for (int x = 0; x < 20; x++)
                    assert_true(part[(k * 10 + y) * 20 + x] ==
                                whole[(k * HEIGHT + where.y0 + y) * WIDTH + where.x0 + x]);
        gscl_reference_free(&reference);
        gscl_coded_image_free(&coded);
        free(params);
    }
}

/* ---- The choices ---- */

typedef struct {
    gscl_accuracy row;
    char variant[32];
} accuracy_row;

typedef struct {
    accuracy_row rows[MAX_ROWS];
    size_t count;
} accuracy_rows;

static void append_row(void *opaque, const gscl_accuracy *accuracy) {
    accuracy_rows *k = opaque;
    assert_true(k->count < MAX_ROWS);
    k->rows[k->count].row = *accuracy;
    strncpy(k->rows[k->count++].variant, accuracy->variant, 31);
}

static const gscl_accuracy_settings quick = {sizeof quick, .repetitions = 1, .splats = 12};

static void measure_file(gscl_context *context, const file *f, accuracy_rows *k) {
    memset(k, 0, sizeof *k);
    if (gscl_measure_accuracy(context, &image, f->bytes, f->size, &quick, append_row, k) != GSCL_OK)
        fail_msg("%s", gscl_context_message(context));
}

/* The rows of one choice, in order; their number. */
static size_t rows_of(const accuracy_rows *k, const char *choice, const gscl_accuracy **rows) {
    size_t count = 0;
    for (size_t i = 0; i < k->count; i++)
        if (strcmp(k->rows[i].row.choice, choice) == 0)
            rows[count++] = &k->rows[i].row;
    return count;
}

static void check_all(const accuracy_rows *k, gscl_blend blend, double psnr) {
    for (size_t i = 0; i < k->count; i++) {
        const gscl_accuracy *a = &k->rows[i].row;
        assert_true(isfinite(a->largest_error) && isfinite(a->mean_error) && isfinite(a->psnr));
        assert_true(a->mean_error >= 0 && a->largest_error >= a->mean_error && a->largest_error <= 255);
        assert_true(a->blend == blend && k->rows[i].variant[0]);
        const bool quantiser = strcmp(a->choice, "quantiser") == 0;
        assert_true(quantiser ? a->ns_per_pixel == 0 : a->ns_per_pixel > 0);
        if (a->is_default && !quantiser)
            assert_true(fabs(a->psnr - psnr) < 0.1);
    }
}

/* The larger the radius of the cut-off, the smaller the error against Gaussians that are not cut off. */
static void check_support(const accuracy_rows *k) {
    const gscl_accuracy *rows[MAX_ROWS];
    const size_t count = rows_of(k, "support", rows);
    assert_true(count >= 5 && rows[0]->value == 2 && rows[count - 1]->value == 6);
    for (size_t i = 1; i < count; i++)
        assert_true(rows[i]->value > rows[i - 1]->value && rows[i]->mean_error < rows[i - 1]->mean_error);
    assert_true(rows[count - 1]->mean_error < 1e-3 && rows[0]->mean_error > 0.1);
}

static void check_arithmetic(const accuracy_rows *k) {
    const gscl_accuracy *rows[MAX_ROWS];
    const size_t exponentials = rows_of(k, "exponential", rows);
    assert_int_equal(exponentials, 3);
    for (size_t i = 0; i < exponentials; i++)
        assert_true(rows[i]->largest_error < 0.02);
    const size_t precisions = rows_of(k, "precision", rows);
    assert_true(precisions >= 1 && rows[0]->is_default);
    if (precisions == 2)
        assert_true(rows[1]->largest_error < 1e-9 && rows[1]->largest_error < 1e-4 * rows[0]->largest_error);
}

static void check_early_stop(const accuracy_rows *k, bool expected) {
    const gscl_accuracy *rows[MAX_ROWS];
    const size_t count = rows_of(k, "early stop", rows);
    assert_true((count > 0) == expected);
    for (size_t i = 0; i < count; i++) /* omitted splats contribute at most the transmittance */
        assert_true(rows[i]->largest_error <= 255 * rows[i]->value + 0.02);
    if (count)
        assert_true(rows[count - 1]->largest_error > rows[0]->largest_error);
}

static void check_quantiser(const accuracy_rows *k, bool expected) {
    const gscl_accuracy *rows[MAX_ROWS];
    const size_t count = rows_of(k, "quantiser", rows);
    assert_true((count > 0) == expected);
    for (size_t i = 2; i < count; i++)
        assert_true(rows[i]->value > rows[i - 1]->value && rows[i]->bits_per_splat < rows[i - 1]->bits_per_splat);
    if (count) {
        assert_true(rows[0]->value == 0 && rows[0]->mean_error == 0);
        assert_true(rows[2]->mean_error < rows[count - 1]->mean_error);
    }
}

static void test_choices(void **state) {
    (void)state;
    static accuracy_rows k;
    for (int i = 0; i < BLENDS; i++)
        for (int m = 0; m < 2; m++) {
            const bool alpha = GSCL_BLEND_NORMALIZED + i == GSCL_BLEND_ALPHA;
            measure_file(contexts[m], &files[i], &k);
            check_all(&k, (gscl_blend)(GSCL_BLEND_NORMALIZED + i), files[i].psnr);
            check_support(&k);
            check_arithmetic(&k);
            check_early_stop(&k, alpha);
            check_quantiser(&k, !alpha);
        }
}

/* ---- Quantiser steps of an encode ---- */

static gscl_result encode_with_steps(double factor, gscl_profile profile, file *f, uint32_t *splats) {
    gscl_encode_settings settings;
    gscl_encode_report report = {.struct_size = sizeof report};
    gscl_encode_settings_default(&settings);
    settings.profile = profile;
    settings.effort = 1;
    settings.target = GSCL_TARGET_BYTES;
    settings.target_value = 500;
    settings.step_factor = factor;
    const gscl_result result = gscl_encode(contexts[0], &image, &settings, &f->bytes, &f->size, &report);
    *splats = report.splats;
    return result;
}

/* Finer steps leave room for fewer splats. */
static void test_step_factor(void **state) {
    (void)state;
    const double factors[] = {0.5, 0, 1, 2};
    file f[4];
    uint32_t splats[4];
    for (int i = 0; i < 4; i++) {
        assert_int_equal(encode_with_steps(factors[i], GSCL_PROFILE_DEFAULT, &f[i], &splats[i]), GSCL_OK);
        assert_true(f[i].size <= 500);
    }
    assert_true(splats[0] < splats[1] && splats[2] < splats[3]);
    assert_int_equal(f[1].size, f[2].size);
    assert_memory_equal(f[1].bytes, f[2].bytes, f[1].size);
    for (int i = 0; i < 4; i++)
        gscl_free(f[i].bytes);
    const double wrong[] = {0.2, 4.1, -1, NAN};
    for (int i = 0; i < 4; i++)
        assert_int_equal(encode_with_steps(wrong[i], GSCL_PROFILE_DEFAULT, &f[0], splats), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(encode_with_steps(2, GSCL_PROFILE_PAPER, &f[0], splats), GSCL_ERROR_CONFLICT);
}

/* ---- The derivatives ---- */

static void check_gradient(void *opaque, const gscl_gradient_accuracy *a) {
    assert_true(a->parameters > 0 && a->ns_per_pixel > 0);
    if (!(a->rms_error < 1e-3 && a->largest_error < 1e-3))
        fail_msg("%s, %s: off by %g, at most by %g", a->kind, a->variant, a->rms_error, a->largest_error);
    ++*(int *)opaque;
}

static void test_gradients(void **state) {
    (void)state;
    for (int i = 0; i < BLENDS; i++)
        for (int m = 0; m < 2; m++) {
            int count = 0;
            assert_int_equal(gscl_measure_gradients(contexts[m], &image, files[i].bytes, files[i].size, &quick,
                                                    check_gradient, &count),
                             GSCL_OK);
            assert_true(count >= 3 * 2 && count <= 3 * 5 &&
                        count % 3 == 0); /* rows for each kind that the shapes have, for three variants */
        }
}

/* ---- Decoding ---- */

/* A file whose colours and whose alpha vary. */
static file encode_transparent(void) {
    file f;
    uint8_t pixels[HEIGHT][WIDTH][4];
    const gscl_image transparent = {WIDTH, HEIGHT, 4, GSCL_SAMPLE_U8, 0, false, pixels, GSCL_LAYOUT_RGBA};
    gscl_encode_settings settings;
    gscl_encode_settings_default(&settings);
    settings.effort = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            memcpy(pixels[y][x], (uint8_t[4]){(uint8_t)(2 * x), (uint8_t)(3 * y), 99, (uint8_t)(2 * y + x)}, 4);
    assert_int_equal(gscl_encode(contexts[0], &transparent, &settings, &f.bytes, &f.size, NULL), GSCL_OK);
    return f;
}

static void check_decoding(gscl_context *context, const file *f) {
    double error = -1;
    assert_int_equal(gscl_measure_decoding(context, f->bytes, f->size, &error), GSCL_OK);
    if (!(error > 0 && error < 0.01)) /* in single precision, rounded */
        fail_msg("%s: %g/255", gscl_context_device(context)->id, error);
}

static void test_decoding(void **state) {
    (void)state;
    gscl_context *host;
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    settings.device = GSCL_HOST_DEVICE;
    assert_int_equal(gscl_context_create(&host, &settings), GSCL_OK);
    file transparent = encode_transparent();
    gscl_context *const all[] = {contexts[0], contexts[1], host};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < BLENDS; k++)
            check_decoding(all[i], &files[k]);
        check_decoding(all[i], &transparent);
    }
    double error = -1;
    assert_int_equal(gscl_measure_decoding(host, transparent.bytes, transparent.size - 9, &error),
                     GSCL_ERROR_TRUNCATED);
    assert_true(gscl_context_message(host)[0] && error == -1);
    assert_int_equal(gscl_measure_decoding(NULL, transparent.bytes, transparent.size, &error),
                     GSCL_ERROR_INVALID_ARGUMENT);
    gscl_free(transparent.bytes);
    gscl_context_free(&host);
}

/* ---- Refusals ---- */

static void never(void *opaque, const gscl_accuracy *accuracy) {
    (void)opaque;
    fail_msg("%s was measured", accuracy->choice);
}

static void refuse(gscl_context *context, const gscl_image *what, const file *f, size_t size,
                   const gscl_accuracy_settings *settings, gscl_result expected) {
    assert_int_equal(gscl_measure_accuracy(context, what, f->bytes, size, settings, never, NULL), expected);
    assert_true(gscl_context_message(context)[0]);
}

static void test_refusals(void **state) {
    (void)state;
    const file *f = &files[0];
    gscl_context *untimed;
    gscl_image other = image;
    gscl_accuracy_settings wrong;
    assert_true(open_on(&untimed, first_opencl_device(), GSCL_MAPPING_AUTO));
    refuse(untimed, &image, f, f->size, NULL, GSCL_ERROR_INVALID_ARGUMENT);
    assert_non_null(strstr(gscl_context_message(untimed), "timing"));
    other.width--;
    refuse(contexts[0], &other, f, f->size, NULL, GSCL_ERROR_INVALID_ARGUMENT);
    refuse(contexts[0], &image, f, f->size - 9, NULL, GSCL_ERROR_TRUNCATED);
    for (int i = 0; i < 4; i++) {
        gscl_accuracy_settings_default(&wrong);
        *(i & 1 ? &wrong.repetitions : &wrong.splats) = i & 2 ? 0 : 1001;
        refuse(contexts[0], &image, f, f->size, &wrong, GSCL_ERROR_INVALID_ARGUMENT);
    }
    assert_int_equal(gscl_measure_accuracy(contexts[0], &image, f->bytes, f->size, NULL, NULL, NULL),
                     GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_measure_gradients(NULL, &image, f->bytes, f->size, NULL, check_gradient, NULL),
                     GSCL_ERROR_INVALID_ARGUMENT);
    gscl_context_free(&untimed);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reference_draws_what_the_oracle_draws),
        cmocka_unit_test(test_reference_draws_parts),
        cmocka_unit_test(test_choices),
        cmocka_unit_test(test_step_factor),
        cmocka_unit_test(test_gradients),
        cmocka_unit_test(test_decoding),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
