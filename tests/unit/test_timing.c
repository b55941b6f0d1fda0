/* Timings of stages and kernels (gscl_context_timings), and settings that a benchmark refuses. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>
#include <gscl/measure.h>

#include "devices.h"

#define WIDTH 40
#define HEIGHT 24
#define DECODED_SCALE 16 /* a decode enlarges the image, so that it has too many pixels to be drawn in software */

static gscl_context *new_context(bool timing) {
    gscl_context *context;
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    settings.device = test_device();
    settings.timing = timing;
    assert_int_equal(gscl_context_create(&context, &settings), GSCL_OK);
    return context;
}

/* Encodes a gradient of at most HEIGHT rows and decodes it again. */
static void encode_and_decode_rows(gscl_context *context, uint32_t rows) {
    uint8_t pixels[WIDTH * HEIGHT], *bytes;
    size_t size;
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        pixels[i] = (uint8_t)(5 * (i % WIDTH) + i / WIDTH);
    const gscl_image image = {
        .width = WIDTH, .height = rows, .channels = 1, .sample = GSCL_SAMPLE_U8, .pixels = pixels};
    gscl_image decoded = {0};
    gscl_encode_settings settings;
    gscl_decode_settings larger;
    gscl_encode_settings_default(&settings);
    gscl_decode_settings_default(&larger);
    settings.effort = 0;
    larger.width = DECODED_SCALE * WIDTH;
    larger.height = DECODED_SCALE * rows;
    assert_int_equal(gscl_encode(context, &image, &settings, &bytes, &size, NULL), GSCL_OK);
    assert_int_equal(gscl_decode(context, bytes, size, &larger, &decoded), GSCL_OK);
    gscl_free(decoded.pixels);
    gscl_free(bytes);
}

static void encode_and_decode(gscl_context *context) {
    encode_and_decode_rows(context, HEIGHT);
}

static const gscl_timing *find_timing(const gscl_context *context, const char *name, bool is_kernel) {
    for (const gscl_timing *row = gscl_context_timings(context); row; row = row->next)
        if (row->is_kernel == is_kernel && strcmp(row->name, name) == 0)
            return row;
    fail_msg("%s was not measured", name);
    return NULL;
}

static void test_no_timings_without_the_setting(void **state) {
    (void)state;
    gscl_context *context = new_context(false);
    encode_and_decode(context);
    assert_null(gscl_context_timings(context));
    gscl_context_reset_timings(context);
    gscl_context_free(&context);
}

static void test_stages_and_kernels(void **state) {
    (void)state;
    static const char *const stages[] = {"prepare", "pyramid", "entropy coding", "write", "entropy decoding", "draw"};
    static const char *const kernels[] = {"bin", "fit_tiles", "step_splats", "raster_samples"};
    gscl_context *context = new_context(true);
    encode_and_decode(context);
    for (size_t i = 0; i < sizeof stages / sizeof *stages; i++) {
        const gscl_timing *row = find_timing(context, stages[i], false);
        assert_true(row->count > 0 && row->seconds > 0 && row->kernel_seconds <= row->seconds);
    }
    for (size_t i = 0; i < sizeof kernels / sizeof *kernels; i++)
        assert_true(find_timing(context, kernels[i], true)->seconds > 0);
    gscl_context_free(&context);
}

/* A decode launches raster_samples once, with work-items for all pixels. */
static void test_work_items(void **state) {
    (void)state;
    gscl_context *context = new_context(true);
    encode_and_decode(context);
    for (const gscl_timing *row = gscl_context_timings(context); row; row = row->next)
        assert_true((row->fewest_items > 0) == row->is_kernel && row->items >= row->count * row->fewest_items);
    const uint64_t large = find_timing(context, "raster_samples", true)->items;
    gscl_context_reset_timings(context);
    encode_and_decode_rows(context, HEIGHT / 2);
    const uint64_t small = find_timing(context, "raster_samples", true)->items;
    encode_and_decode(context);
    const gscl_timing *both = find_timing(context, "raster_samples", true);
    assert_true(small < large);
    assert_int_equal(both->fewest_items, small);
    assert_int_equal(both->items, small + large);
    gscl_context_free(&context);
}

/* Every kernel runs within a stage. */
static void test_kernels_are_in_stages(void **state) {
    (void)state;
    double in_stages = 0, alone = 0;
    gscl_context *context = new_context(true);
    encode_and_decode(context);
    for (const gscl_timing *row = gscl_context_timings(context); row; row = row->next) {
        in_stages += row->is_kernel ? 0 : row->kernel_seconds;
        alone += row->is_kernel ? row->seconds : 0;
    }
    assert_true(fabs(in_stages - alone) < 1e-6 + 1e-9 * alone);
    gscl_context_free(&context);
}

static void test_reset(void **state) {
    (void)state;
    gscl_context *context = new_context(true);
    encode_and_decode(context);
    gscl_context_reset_timings(context);
    for (const gscl_timing *row = gscl_context_timings(context); row; row = row->next)
        assert_true(row->count == 0 && row->seconds == 0 && row->kernel_seconds == 0 && row->waits == 0 &&
                    row->items == 0 && row->fewest_items == 0);
    encode_and_decode(context);
    assert_int_equal(find_timing(context, "write", false)->count, 1);
    assert_true(find_timing(context, "fit, full size", false)->waits > 0);
    assert_int_equal(find_timing(context, "write", false)->waits, 0);
    gscl_context_free(&context);
}

static void count_measurement(void *opaque, const gscl_measurement *measurement) {
    (void)measurement;
    ++*(int *)opaque;
}

static void test_benchmark_refuses(void **state) {
    (void)state;
    int measurements = 0;
    gscl_benchmark_settings settings;
    gscl_context *untimed = new_context(false), *context = new_context(true);
    assert_int_equal(gscl_benchmark_device(untimed, NULL, count_measurement, &measurements),
                     GSCL_ERROR_INVALID_ARGUMENT);
    assert_non_null(strstr(gscl_context_message(untimed), "timing"));
    for (int i = 0; i < 4; i++) {
        gscl_benchmark_settings_default(&settings);
        uint32_t *const wrong[] = {&settings.width, &settings.height, &settings.splats, &settings.repetitions};
        *wrong[i] = 0;
        assert_int_not_equal(gscl_benchmark_kernels(context, &settings, count_measurement, &measurements), GSCL_OK);
        *wrong[i] = UINT32_MAX;
        assert_int_not_equal(gscl_benchmark_kernels(context, &settings, count_measurement, &measurements), GSCL_OK);
    }
    assert_int_equal(gscl_benchmark_kernels(context, NULL, NULL, NULL), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(measurements, 0);
    gscl_context_free(&untimed);
    gscl_context_free(&context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_timings_without_the_setting),
        cmocka_unit_test(test_stages_and_kernels),
        cmocka_unit_test(test_work_items),
        cmocka_unit_test(test_kernels_are_in_stages),
        cmocka_unit_test(test_reset),
        cmocka_unit_test(test_benchmark_refuses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
