/* The host runs out of memory: each allocation of the library fails once, and each failure comes back as a result with a
 * message.  Linked with --wrap for the allocating functions. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>
#include <gscl/measure.h>

#include "devices.h"
#include "joined_tests.h"
#include "synthetic_scene.h"
#include "wrapped_allocations.h"

#define WIDTH 40
#define HEIGHT 24
#define SPLATS 6
#define MAX_FAILURES 60 /* files of one test with a failing allocation; later allocations repeat earlier ones */

static int allocations, failing; /* since the last reset; the number of the one that fails, 0: none */

static bool fails(void) {
    return ++allocations == failing;
}

void *__wrap_malloc(size_t size) {
    return fails() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size) {
    return fails() ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *memory, size_t size) {
    return fails() ? NULL : __real_realloc(memory, size);
}

static void fail_allocation(int number) {
    allocations = 0;
    failing = number;
}

static int open_device(const char *device, void **state) {
    gscl_context *context;
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    settings.device = device;
    settings.timing = true;
    const gscl_result result = gscl_context_create(&context, &settings);
    *state = context;
    return result == GSCL_OK ? 0 : -1;
}

static int open_context(void **state) {
    return open_device(test_device(), state);
}

static int close_context(void **state) {
    gscl_context *context = *state;
    gscl_context_free(&context);
    return 0;
}

static void assert_explained(const gscl_context *context, gscl_result result) {

    if (result != GSCL_ERROR_OUT_OF_MEMORY)
        fail_msg("allocation %d failed, and the result is %d", failing, result);
    assert_non_null(strstr(gscl_context_message(context), "memory"));
}

/* A failure to shrink a block has no consequence; any other sets a message. */
static void assert_same_or_explained(const gscl_context *context, gscl_result result, const uint8_t *bytes, size_t size,
                                     const uint8_t *expected, size_t expected_size) {
    if (result != GSCL_OK) {
        assert_explained(context, result);
        return;
    }
    assert_int_equal(size, expected_size);
    assert_memory_equal(bytes, expected, size);
}

/* A coloured gradient. */
static gscl_image make_image(uint8_t pixels[3 * WIDTH * HEIGHT]) {
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        pixels[3 * i] = (uint8_t)(5 * (i % WIDTH) + i / WIDTH);
        pixels[3 * i + 1] = (uint8_t)(9 * (i / WIDTH));
        pixels[3 * i + 2] = (uint8_t)(255 - 6 * (i % WIDTH));
    }
    return (gscl_image){.width = WIDTH, .height = HEIGHT, .channels = 3, .sample = GSCL_SAMPLE_U8, .pixels = pixels};
}

/* A call that writes a file. */
typedef gscl_result writer(gscl_context *context, uint8_t **bytes, size_t *size);

static gscl_result encode_with_profile(gscl_context *context, gscl_profile profile, uint8_t **bytes, size_t *size) {
    uint8_t pixels[3 * WIDTH * HEIGHT];
    const gscl_image image = make_image(pixels);
    gscl_encode_settings settings;
    gscl_encode_settings_default(&settings);
    settings.profile = profile;
    settings.effort = 0;
    settings.target = GSCL_TARGET_SPLATS;
    settings.target_value = SPLATS;
    return gscl_encode(context, &image, &settings, bytes, size, NULL);
}

static gscl_result encode(gscl_context *context, uint8_t **bytes, size_t *size) {
    return encode_with_profile(context, GSCL_PROFILE_DEFAULT, bytes, size);
}

static gscl_result encode_with_codebooks(gscl_context *context, uint8_t **bytes, size_t *size) {
    return encode_with_profile(context, GSCL_PROFILE_PAPER, bytes, size);
}

/* With a splat that is divided and one that is changed, passes, and a report. */
static gscl_result pack(gscl_context *context, uint8_t **bytes, size_t *size) {
    gscl_splat splats[SPLATS];
    gscl_pack_settings settings;
    gscl_pack_report report = {.struct_size = sizeof report};
    for (int i = 0; i < SPLATS; i++)
        splats[i] = (gscl_splat){.x = 6.1f * (float)i,
                                 .y = 3.7f * (float)i,
                                 .sigma1 = 4,
                                 .sigma2 = i == 2 ? 0.4f : 3,
                                 .opacity = 1,
                                 .colour = {i == 3 ? 3.0f : 0.3f, 0.1f, 0.2f, 1}};
    const gscl_field field = {.struct_size = sizeof field,
                              .width = WIDTH,
                              .height = HEIGHT,
                              .channels = 3,
                              .blend = GSCL_BLEND_SUM,
                              .count = SPLATS,
                              .splats = splats};
    gscl_pack_settings_default(&settings);
    settings.target = GSCL_TARGET_BYTES;
    settings.target_value = 60;
    settings.tolerance = 0.5;
    return gscl_pack(context, &field, &settings, bytes, size, &report);
}

static void write_without_memory(gscl_context *context, writer *write) {
    uint8_t *expected, *bytes;
    size_t expected_size, size;
    fail_allocation(0);
    assert_int_equal(write(context, &expected, &expected_size), GSCL_OK); /* builds the programs */
    gscl_free(expected);
    fail_allocation(0);
    assert_int_equal(write(context, &expected, &expected_size), GSCL_OK);
    const int count = allocations, step = count / MAX_FAILURES + 1;
    assert_true(count > 10);
    for (int number = 1; number <= count; number += number < MAX_FAILURES / 2 ? 1 : step) {
        bytes = NULL;
        fail_allocation(number);
        const gscl_result result = write(context, &bytes, &size);
        assert_true(allocations >= number);
        assert_same_or_explained(context, result, bytes, size, expected, expected_size);
        gscl_free(bytes);
    }
    fail_allocation(0);
    gscl_free(expected);
}

static void test_encode(void **state) {
    write_without_memory(*state, encode);
}

static void test_encode_with_codebooks(void **state) {
    write_without_memory(*state, encode_with_codebooks);
}

static void test_pack(void **state) {
    write_without_memory(*state, pack);
}

/* Each decode has a context of its own, because a context that drew the file before reuses its arrays. */
static void decode_without_memory(const char *device) {
    uint8_t *bytes;
    size_t size;
    assert_true(synthetic_file(WIDTH, HEIGHT, SPLATS, &bytes, &size));
    gscl_result result = GSCL_ERROR_OUT_OF_MEMORY;
    for (int number = 1; result != GSCL_OK; number++) {
        gscl_image decoded = {0};
        void *fresh;
        assert_int_equal(open_device(device, &fresh), 0);
        fail_allocation(number);
        result = gscl_decode(fresh, bytes, size, NULL, &decoded);
        const bool failed = allocations >= number;
        fail_allocation(0);
        if (failed)
            assert_explained(fresh, result);
        gscl_free(decoded.pixels);
        close_context(&fresh);
    }
    free(bytes);
}

static void test_decode_with_opencl(void **state) {
    (void)state;
    decode_without_memory(first_opencl_device());
}

static void test_decode_on_host(void **state) {
    (void)state;
    decode_without_memory(GSCL_HOST_DEVICE);
}

static void test_compare(void **state) {
    (void)state;
    static uint8_t pixels[WIDTH * HEIGHT];
    const gscl_image image = {
        .width = WIDTH, .height = HEIGHT, .channels = 1, .sample = GSCL_SAMPLE_U8, .pixels = pixels};
    gscl_result result = GSCL_ERROR_OUT_OF_MEMORY;
    int number;
    for (number = 1; result != GSCL_OK; number++) {
        gscl_comparison comparison = {.struct_size = sizeof comparison, .mse = -1.0};
        fail_allocation(number);
        result = gscl_compare(&image, &image, &comparison);
        if (allocations >= number)
            assert_true(result == GSCL_ERROR_OUT_OF_MEMORY && comparison.mse == -1.0);
    }
    fail_allocation(0);
    assert_int_equal(number - 2, 3); /* samples, SSIMULACRA 2, SSIM */
}

static void test_context(void **state) {
    (void)state;
    gscl_result result = GSCL_ERROR_OUT_OF_MEMORY;
    for (int number = 1; result != GSCL_OK; number++) {
        gscl_context *context;
        fail_allocation(number);
        result = open_on(&context, test_device(), GSCL_MAPPING_AUTO) ? GSCL_OK : GSCL_ERROR_OUT_OF_MEMORY;
        fail_allocation(0);
        assert_true(result == GSCL_OK || !context || strlen(gscl_context_message(context)) > 0);
        gscl_context_free(&context);
    }
}

static void ignore_gradient(void *opaque, const gscl_gradient_accuracy *error) {
    (void)opaque;
    (void)error;
}

static void ignore_accuracy(void *opaque, const gscl_accuracy *accuracy) {
    (void)opaque;
    (void)accuracy;
}

static void test_measurements(void **state) {
    gscl_context *context = *state;
    uint8_t *bytes, pixels[3 * WIDTH * HEIGHT];
    size_t size;
    const gscl_image image = make_image(pixels);
    assert_int_equal(encode_with_profile(context, GSCL_PROFILE_DEFAULT, &bytes, &size), GSCL_OK);
    for (int number = 1; number <= 4; number++) {
        gscl_effect_use uses[GSCL_EFFECT_COUNT];
        size_t count;
        fail_allocation(number);
        assert_explained(context, gscl_measure_accuracy(context, &image, bytes, size, NULL, ignore_accuracy, NULL));
        fail_allocation(number);
        assert_explained(context, gscl_measure_gradients(context, &image, bytes, size, NULL, ignore_gradient, NULL));
        fail_allocation(number);
        assert_explained(context, gscl_inspect_effects(context, bytes, size, NULL, &image, uses, &count));
    }
    fail_allocation(0);
    gscl_free(bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_decode_on_host),
        cmocka_unit_test(test_context),
    };
    const struct CMUnitTest encoder_tests[] = {
        cmocka_unit_test(test_encode),  cmocka_unit_test(test_encode_with_codebooks),
        cmocka_unit_test(test_pack),    cmocka_unit_test(test_measurements),
        cmocka_unit_test(test_compare),
    };
    const struct CMUnitTest opencl_tests[] = {cmocka_unit_test(test_decode_with_opencl)};
    JOIN_TESTS(tests);
    if (has_encoder())
        JOIN_TESTS(encoder_tests);
    if (has_opencl())
        JOIN_TESTS(opencl_tests);
    return run_joined_tests(open_context, close_context);
}
