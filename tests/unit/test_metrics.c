/* gscl_compare: closed forms, and values of an independent implementation (numpy and scipy, double precision). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "image/image.h"
#include "image/metrics.h"
#include "image/ssimulacra2.h"

#define MAX_SAMPLES (256 * 256 * 4)

static uint8_t pixels_a[MAX_SAMPLES], pixels_b[MAX_SAMPLES];

static gscl_image image_of(uint32_t width, uint32_t height, uint32_t channels, void *pixels) {
    return (gscl_image){
        .width = width, .height = height, .channels = channels, .sample = GSCL_SAMPLE_U8, .pixels = pixels};
}

/* The image that the reference values were computed on: waves, and on the second one grain as well. */
static void draw_waves(uint32_t width, uint32_t height, uint32_t channels) {
    uint32_t state = 12345;
    for (uint32_t i = 0; i < width * height * channels; i++) {
        const uint32_t c = i % channels, x = i / channels % width, y = i / channels / width;
        const uint32_t value = 40 + 20 * c + (x * x / 16 + 3 * y) % 97;
        state = state * 1664525u + 1013904223u;
        pixels_a[i] = (uint8_t)value;
        pixels_b[i] = (uint8_t)(value + (state >> 27));
    }
}

static gscl_comparison compare(uint32_t width, uint32_t height, uint32_t channels) {
    const gscl_image a = image_of(width, height, channels, pixels_a), b = image_of(width, height, channels, pixels_b);
    gscl_comparison comparison = {.struct_size = sizeof comparison};
    assert_int_equal(gscl_compare(&a, &b, &comparison), GSCL_OK);
    return comparison;
}

static void assert_near(double value, double expected, double tolerance) {
    if (!(fabs(value - expected) <= tolerance))
        fail_msg("%.12g is not within %g of %.12g", value, tolerance, expected);
}

static void fill_pixels(uint8_t *pixels, size_t count, uint8_t value) {
    for (size_t i = 0; i < count; i++)
        pixels[i] = value;
}

static void test_equal_images(void **state) {
    (void)state;
    draw_waves(180, 190, 3);
    const gscl_image a = image_of(180, 190, 3, pixels_a);
    gscl_comparison comparison = {.struct_size = sizeof comparison};
    assert_int_equal(gscl_compare(&a, &a, &comparison), GSCL_OK);
    assert_true(comparison.mse == 0.0 && comparison.max_difference == 0.0);
    assert_true(isinf(comparison.psnr) && comparison.psnr > 0.0);
    assert_near(comparison.ssim, 1.0, 1e-9);
    assert_near(comparison.ms_ssim, 1.0, 1e-9);
    assert_true(comparison.ssimulacra2 == 100.0);
}

/* Between two flat images only SSIM's luminance factor is left: (2 a b + C1) / (a^2 + b^2 + C1). */
static void test_flat_images(void **state) {
    (void)state;
    fill_pixels(pixels_a, MAX_SAMPLES, 100);
    fill_pixels(pixels_b, MAX_SAMPLES, 110);
    const gscl_comparison comparison = compare(176, 176, 1);
    const double c1 = 2.55 * 2.55, luminance = (2.0 * 100.0 * 110.0 + c1) / (100.0 * 100.0 + 110.0 * 110.0 + c1);
    assert_near(comparison.mse, 100.0, 1e-3);
    assert_near(comparison.psnr, 10.0 * log10(255.0 * 255.0 / 100.0), 1e-5);
    assert_near(comparison.max_difference, 10.0, 1e-4);
    assert_near(comparison.ssim, luminance, 1e-6);
    assert_near(comparison.ms_ssim, pow(luminance, 0.1333), 1e-6);
}

/* An anticorrelated pair has negative contrast factors, which MS-SSIM counts as 0. */
static void test_negative_image(void **state) {
    (void)state;
    draw_waves(176, 176, 1);
    for (uint32_t i = 0; i < 176 * 176; i++)
        pixels_b[i] = (uint8_t)(255 - pixels_a[i]);
    const gscl_comparison comparison = compare(176, 176, 1);
    assert_true(comparison.ssim < 0.0);
    assert_true(comparison.ms_ssim == 0.0);
}

typedef struct reference {
    uint32_t width, height, channels;
    double mse, ssim, ms_ssim;
} reference;

static void test_reference_values(void **state) {
    (void)state;
    static const reference references[] = {
        {176, 176, 1, 322.555204029, 0.866753162, 0.978899922},
        {161, 163, 3, 324.756061934, 0.861656816, 0.979990289},
        {200, 177, 1, 322.598050847, 0.876022846, 0.977337125},
        {250, 190, 3, 325.173291228, 0.891238247, 0.975794095},
    };
    for (size_t i = 0; i < sizeof references / sizeof *references; i++) {
        const reference *expected = &references[i];
        draw_waves(expected->width, expected->height, expected->channels);
        const gscl_comparison comparison = compare(expected->width, expected->height, expected->channels);
        assert_near(comparison.mse, expected->mse, 1e-4);
        assert_near(comparison.psnr, 10.0 * log10(255.0 * 255.0 / expected->mse), 1e-5);
        assert_near(comparison.ssim, expected->ssim, 1e-6);
        assert_near(comparison.ms_ssim, expected->ms_ssim, 1e-6);
    }
}

typedef struct ssimulacra2_reference {
    uint32_t width, height, channels;
    double added, lost; /* scores of the grain as a change of the waves, and of the waves as a change of both */
} ssimulacra2_reference;

/* Scores of the Rust crate ssimulacra2 0.5.1, which computes in single precision.  The first images have all six scales,
 * the last three have two, two and three. */
static void test_ssimulacra2_reference_values(void **state) {
    (void)state;
    static const ssimulacra2_reference references[] = {
        {176, 176, 1, 34.310, 36.486}, {161, 163, 3, 45.910, 48.977}, {250, 190, 3, 41.119, 43.461},
        {8, 8, 3, 85.099, 91.883},     {9, 30, 3, 85.013, 89.576},    {40, 17, 1, 83.972, 86.161},
    };
    for (size_t i = 0; i < sizeof references / sizeof *references; i++) {
        const ssimulacra2_reference *expected = &references[i];
        const uint32_t width = expected->width, height = expected->height, channels = expected->channels;
        draw_waves(width, height, channels);
        const gscl_image a = image_of(width, height, channels, pixels_a),
                         b = image_of(width, height, channels, pixels_b);
        gscl_comparison comparison = {.struct_size = sizeof comparison};
        assert_near(compare(width, height, channels).ssimulacra2, expected->added, 0.03);
        assert_int_equal(gscl_compare(&b, &a, &comparison), GSCL_OK);
        assert_near(comparison.ssimulacra2, expected->lost, 0.03);
    }
}

/* The score in front of one background, whose samples are exact. */
static double score_before(const gscl_image *a, const gscl_image *b, float background) {
    static float planes[2][3 * 24 * 24];
    const gscl_image *images[2] = {a, b};
    const size_t pixels = (size_t)a->width * a->height;
    double sum;
    for (int which = 0; which < 2; which++)
        for (size_t i = 0; i < pixels; i++) {
            gscl_pixels p;
            gscl_image_read(images[which], (uint32_t)i % a->width, (uint32_t)i / a->width, 1, &p);
            for (int c = 0; c < 3; c++)
                planes[which][(size_t)c * pixels + i] = p.colour[c][0] + (1.0f - p.alpha[0]) * background;
        }
    assert_int_equal(gscl_ssimulacra2_sum(planes[0], planes[1], a->width, a->height, 3, &sum), GSCL_OK);
    return gscl_ssimulacra2_score(sum);
}

/* With alpha the worse of the scores in front of a dark and of a bright background counts. */
static void test_ssimulacra2_of_alpha(void **state) {
    (void)state;
    for (uint32_t channels = 2; channels <= 4; channels += 2) {
        draw_waves(24, 24, channels);
        const gscl_image a = image_of(24, 24, channels, pixels_a), b = image_of(24, 24, channels, pixels_b);
        const double dark = score_before(&a, &b, 0.1f), bright = score_before(&a, &b, 0.9f);
        assert_true(fabs(dark - bright) > 0.1);
        assert_near(compare(24, 24, channels).ssimulacra2, fmin(dark, bright), 1e-4);
    }
}

static void test_ssimulacra2_sum(void **state) {
    (void)state;
    static const float black[64], white[64] = {1.0f};
    double sum = -1.0;
    assert_int_equal(gscl_ssimulacra2_sum(black, white, 8, 8, 1, &sum), GSCL_OK);
    assert_true(sum > 0.0 && gscl_ssimulacra2_score(sum) < 100.0);
    assert_int_equal(gscl_ssimulacra2_sum(white, white, 8, 8, 1, &sum), GSCL_OK);
    assert_true(sum == 0.0 && gscl_ssimulacra2_score(sum) == 100.0);
    assert_int_equal(gscl_ssimulacra2_sum(black, white, 8, 7, 1, &sum), GSCL_OK);
    assert_true(isnan(sum) && isnan(gscl_ssimulacra2_score(sum)));
    for (sum = 1.0; sum < 1000.0; sum++)
        assert_true(gscl_ssimulacra2_score(sum) < gscl_ssimulacra2_score(sum - 1.0));
}

static void test_small_images(void **state) {
    (void)state;
    draw_waves(200, 200, 1);
    assert_true(isnan(compare(10, 200, 1).ssim));
    assert_true(isnan(compare(200, 10, 1).ms_ssim));
    assert_false(isnan(compare(11, 11, 1).ssim));
    assert_true(isnan(compare(200, 160, 1).ms_ssim)); /* 160 halves to 10 */
    assert_false(isnan(compare(200, 161, 1).ms_ssim));
    assert_false(isnan(compare(1, 1, 4).mse));
    assert_true(isnan(compare(7, 200, 1).ssimulacra2));
    assert_true(isnan(compare(200, 7, 4).ssimulacra2));
    assert_false(isnan(compare(8, 8, 1).ssimulacra2));
}

static void test_alpha_counts_premultiplied(void **state) {
    (void)state;
    const uint8_t straight[4] = {200, 100, 50, 51}, other[4] = {0, 100, 50, 51}, multiplied[4] = {40, 20, 10, 51};
    gscl_image a = image_of(1, 1, 4, (void *)(uintptr_t)straight), b = image_of(1, 1, 4, (void *)(uintptr_t)other);
    gscl_comparison comparison = {.struct_size = sizeof comparison};
    assert_int_equal(gscl_compare(&a, &b, &comparison), GSCL_OK);
    assert_near(comparison.max_difference, 200.0 * 51.0 / 255.0, 1e-4);
    assert_near(comparison.mse, 40.0 * 40.0 / 4.0, 1e-2);
    b = image_of(1, 1, 4, (void *)(uintptr_t)multiplied);
    b.premultiplied = true;
    assert_int_equal(gscl_compare(&a, &b, &comparison), GSCL_OK);
    assert_near(comparison.max_difference, 0.0, 1e-4);
}

static void test_sample_types_and_strides(void **state) {
    (void)state;
    enum { WIDTH = 20, HEIGHT = 15, STRIDE = 64 };
    static uint16_t high_bit_depth[HEIGHT][STRIDE];
    static float real[HEIGHT][STRIDE];
    draw_waves(WIDTH, HEIGHT, 1);
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            high_bit_depth[y][x] = (uint16_t)(pixels_a[y * WIDTH + x] * 257);
            real[y][x] = (float)pixels_a[y * WIDTH + x] / 255.0f;
        }
    }
    const gscl_image a = image_of(WIDTH, HEIGHT, 1, pixels_a);
    gscl_image b = image_of(WIDTH, HEIGHT, 1, high_bit_depth), c = image_of(WIDTH, HEIGHT, 1, real);
    gscl_comparison comparison = {.struct_size = sizeof comparison};
    b.sample = GSCL_SAMPLE_U16;
    b.stride = sizeof *high_bit_depth;
    c.sample = GSCL_SAMPLE_F32;
    c.stride = sizeof *real;
    assert_int_equal(gscl_compare(&a, &b, &comparison), GSCL_OK);
    assert_near(comparison.max_difference, 0.0, 1e-4);
    assert_int_equal(gscl_compare(&b, &c, &comparison), GSCL_OK);
    assert_near(comparison.max_difference, 0.0, 1e-4);
}

static void test_samples_alone(void **state) {
    (void)state;
    draw_waves(180, 180, 2);
    const gscl_image a = image_of(180, 180, 2, pixels_a), b = image_of(180, 180, 2, pixels_b);
    gscl_comparison samples;
    const gscl_comparison whole = compare(180, 180, 2);
    assert_int_equal(gscl_compare_samples(&a, &b, &samples), GSCL_OK);
    assert_true(samples.mse == whole.mse && samples.psnr == whole.psnr);
    assert_true(samples.max_difference == whole.max_difference && isnan(samples.ssim) && isnan(samples.ms_ssim));
    assert_true(isnan(samples.ssimulacra2));
}

static void test_appearance_alone(void **state) {
    (void)state;
    double score = 0;
    for (uint32_t channels = 1; channels <= 4; channels++) {
        draw_waves(60, 40, channels);
        const gscl_image a = image_of(60, 40, channels, pixels_a), b = image_of(60, 40, channels, pixels_b);
        assert_int_equal(gscl_compare_appearance(&a, &b, &score), GSCL_OK);
        assert_true(score == compare(60, 40, channels).ssimulacra2);
    }
    const gscl_image a = image_of(20, 7, 3, pixels_a), b = image_of(20, 8, 3, pixels_a);
    assert_int_equal(gscl_compare_appearance(&a, &b, &score), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_compare_appearance(&a, &a, &score), GSCL_OK);
    assert_true(isnan(score));
}

static void test_wrong_arguments(void **state) {
    (void)state;
    const gscl_image a = image_of(20, 20, 3, pixels_a);
    gscl_image b = a;
    gscl_comparison comparison = {.struct_size = sizeof comparison, .mse = -1.0};
    assert_int_equal(gscl_compare(&a, &b, NULL), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_compare(NULL, &b, &comparison), GSCL_ERROR_INVALID_ARGUMENT);
    b.width = 19;
    assert_int_equal(gscl_compare(&a, &b, &comparison), GSCL_ERROR_INVALID_ARGUMENT);
    b = image_of(20, 20, 4, pixels_b);
    assert_int_equal(gscl_compare(&a, &b, &comparison), GSCL_ERROR_INVALID_ARGUMENT);
    b = a;
    b.stride = 59;
    assert_int_equal(gscl_compare(&a, &b, &comparison), GSCL_ERROR_INVALID_ARGUMENT);
    b = a;
    b.sample = GSCL_SAMPLE_AUTO;
    assert_int_equal(gscl_compare(&a, &b, &comparison), GSCL_ERROR_INVALID_ARGUMENT);
    b = image_of(20, 0, 3, pixels_a);
    assert_int_equal(gscl_compare(&b, &b, &comparison), GSCL_ERROR_INVALID_ARGUMENT);
    assert_true(comparison.mse == -1.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_equal_images),
        cmocka_unit_test(test_flat_images),
        cmocka_unit_test(test_negative_image),
        cmocka_unit_test(test_reference_values),
        cmocka_unit_test(test_small_images),
        cmocka_unit_test(test_alpha_counts_premultiplied),
        cmocka_unit_test(test_samples_alone),
        cmocka_unit_test(test_sample_types_and_strides),
        cmocka_unit_test(test_appearance_alone),
        cmocka_unit_test(test_wrong_arguments),
        cmocka_unit_test(test_ssimulacra2_reference_values),
        cmocka_unit_test(test_ssimulacra2_of_alpha),
        cmocka_unit_test(test_ssimulacra2_sum),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
