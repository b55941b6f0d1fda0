/* Each allocation and each call of OpenCL fails once, in a decode, an encode and an inspection.  Every failure comes back
 * as a result with a message and without a leak, and the context works afterwards.
 *
 * The encodes take a sample of the faults: ENCODE_FAULTS of each kind and profile, or as many as GSCL_FAULTS says. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>
#include <gscl/measure.h>

#include "devices.h"
#include "faults.h"
#include "opencl_faults.h"

#define WIDTH 40
#define HEIGHT 24
#define SPLATS 6
#define ENCODE_FAULTS 40

static uint8_t *file; /* made once; the subject of decodes */
static size_t file_size;

static gscl_result create_context(gscl_context **context, const char *device) {
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    settings.device = device;
    return gscl_context_create(context, &settings);
}

static gscl_context *open_device(const char *device) {
    gscl_context *context;
    assert_int_equal(create_context(&context, device), GSCL_OK);
    return context;
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

static gscl_result encode(gscl_context *context, gscl_profile profile, uint8_t **bytes, size_t *size) {
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

/* Rows of a decode: one after another, with gaps between them, or grey of the colours from the bottom up. */
typedef enum rows_form { PACKED, GAPS, GREY } rows_form;

static gscl_result decode(gscl_context *context, rows_form form, uint8_t pixels[HEIGHT][4 * WIDTH]) {
    gscl_decode_settings settings;
    gscl_decode_settings_default(&settings);
    settings.layout = form == GREY ? GSCL_LAYOUT_GREY : GSCL_LAYOUT_AUTO;
    gscl_image image = {.width = WIDTH,
                        .height = HEIGHT,
                        .channels = form == GREY ? 1 : 3,
                        .sample = GSCL_SAMPLE_U8,
                        .stride = form == PACKED ? 0
                                  : form == GAPS ? 4 * WIDTH
                                                 : -4 * WIDTH,
                        .pixels = pixels[form == GREY ? HEIGHT - 1 : 0]};
    return gscl_decode(context, file, file_size, &settings, &image);
}

/* A fault either has no consequence or is a failure of its kind with a message. */
static void assert_explained(const gscl_context *context, gscl_result result, fault_kind kind, int number) {
    const char *message = context ? gscl_context_message(context) : gscl_result_text(result);
    if (fault_released_too_early())
        fail_msg("fault %d of kind %d (%s): memory was released that a copy may still use", number, kind, fault_call());
    if (result == GSCL_OK)
        return;
    if (!message[0])
        fail_msg("fault %d of kind %d (%s): result %d without a message", number, kind, fault_call(), (int)result);
    if (kind == FAULT_MEMORY && result != GSCL_ERROR_OUT_OF_MEMORY)
        fail_msg("allocation %d failed, and the result is %d: %s", number, (int)result, message);
    if (kind != FAULT_MEMORY && result != GSCL_ERROR_DEVICE_FAILED && result != GSCL_ERROR_KERNEL_BUILD &&
        result != GSCL_ERROR_NO_PLATFORM && result != GSCL_ERROR_UNKNOWN_DEVICE) /* which cannot be queried */
        fail_msg("fault %d of kind %d (%s): result %d: %s", number, kind, fault_call(), (int)result, message);
}

/* ---- Decoding ---------------------------------------------------------------------------------- */

/* One decode with a fault and two without, in a context of their own. */
static bool decode_with_fault(const char *device, fault_kind kind, int number, bool forever, rows_form form) {
    uint8_t first[HEIGHT][4 * WIDTH] = {{0}}, expected[HEIGHT][4 * WIDTH] = {{0}}, later[HEIGHT][4 * WIDTH] = {{0}};
    const int live = fault_live_blocks();
    gscl_context *context = open_device(device), *other = open_device(device);
    assert_int_equal(decode(other, form, expected), GSCL_OK);
    faults_begin(kind, number, forever);
    const gscl_result result = decode(context, form, first);
    const bool reached = faults_end(kind) >= number;
    assert_explained(context, result, kind, number);
    if (result == GSCL_OK)
        assert_memory_equal(first, expected, sizeof expected);
    for (int i = 0; i < 2; i++) {
        if (decode(context, form, later) != GSCL_OK)
            fail_msg("after fault %d of kind %d (%s): %s", number, kind, fault_call(), gscl_context_message(context));
        assert_memory_equal(later, expected, sizeof expected);
    }
    gscl_context_free(&context);
    gscl_context_free(&other);
    assert_false(fault_released_too_early());
    assert_int_equal(fault_live_blocks(), live);
    return reached;
}

static void sweep_decodes(const char *device, fault_kind kind, bool forever, rows_form form, int at_least) {
    int number = 1;
    while (decode_with_fault(device, kind, number, forever, form))
        number++;
    assert_true(number > at_least);
    print_message("# %d faults of kind %d in a decode\n", number - 1, kind);
}

static void test_decode_opencl(void **state) {
    (void)state;
    sweep_decodes(first_opencl_device(), FAULT_OPENCL, false, PACKED, 40);
}

static void test_decode_opencl_rows_with_gaps(void **state) {
    (void)state;
    sweep_decodes(first_opencl_device(), FAULT_OPENCL, true, GAPS, 40);
}

static void test_decode_buffers(void **state) {
    (void)state;
    sweep_decodes(first_opencl_device(), FAULT_BUFFER, false, PACKED, 10);
    sweep_decodes(first_opencl_device(), FAULT_BUFFER, true, PACKED, 10);
}

/* No call succeeds from some moment on: the device cannot be waited for, either.  A decode waits for its image alone, so that
 * clFinish is called after an error only. */
static void test_decode_lost_device(void **state) {
    (void)state;
    sweep_decodes(first_opencl_device(), FAULT_FINISH, false, PACKED, 0);
    sweep_decodes(first_opencl_device(), FAULT_OPENCL, true, PACKED, 40);
}

static void test_decode_memory(void **state) {
    (void)state;
    sweep_decodes(first_opencl_device(), FAULT_MEMORY, false, PACKED, 4);
    sweep_decodes(first_opencl_device(), FAULT_MEMORY, true, PACKED, 4);
    sweep_decodes(GSCL_HOST_DEVICE, FAULT_MEMORY, false, PACKED, 3);
    sweep_decodes(GSCL_HOST_DEVICE, FAULT_MEMORY, true, PACKED, 3);
    sweep_decodes(first_opencl_device(), FAULT_MEMORY, false, GREY, 5);
    sweep_decodes(GSCL_HOST_DEVICE, FAULT_MEMORY, false, GREY, 4);
}

/* ---- Encoding ---------------------------------------------------------------------------------- */

static void encode_with_fault(gscl_context *context, gscl_profile profile, fault_kind kind, int number, bool forever) {
    uint8_t *bytes = NULL;
    size_t size;
    faults_begin(kind, number, forever);
    const gscl_result result = encode(context, profile, &bytes, &size);
    assert_true(faults_end(kind) >= number);
    assert_explained(context, result, kind, number);
    assert_true(result == GSCL_OK || !bytes);
    gscl_free(bytes);
}

/* A context has built its programs in an encode before, but for every fourth fault. */
static void sweep_encodes(gscl_profile profile, fault_kind kind, bool forever) {
    const char *wanted = getenv("GSCL_FAULTS");
    const int sample = wanted ? atoi(wanted) : ENCODE_FAULTS;
    const int live = fault_live_blocks();
    uint8_t *expected, *bytes;
    size_t expected_size, size;
    gscl_context *context = open_device(first_opencl_device());
    assert_int_equal(encode(context, profile, &expected, &expected_size), GSCL_OK);
    gscl_free(expected);
    faults_begin(kind, 0, false);
    assert_int_equal(encode(context, profile, &expected, &expected_size), GSCL_OK);
    const int count = faults_end(kind), step = count / (sample > 0 ? sample : 1) + 1;
    int faults = 0;
    assert_true(count > 0);
    for (int number = 1; number <= count; number += step, faults++) {
        if (faults % 4 == 3) {
            gscl_context_free(&context);
            context = open_device(first_opencl_device());
        }
        encode_with_fault(context, profile, kind, number, forever);
    }
    assert_int_equal(encode(context, profile, &bytes, &size), GSCL_OK);
    assert_int_equal(size, expected_size);
    assert_memory_equal(bytes, expected, size);
    gscl_free(bytes);
    gscl_free(expected);
    gscl_context_free(&context);
    assert_false(fault_released_too_early());
    assert_int_equal(fault_live_blocks(), live);
    print_message("# %d of %d faults of kind %d in an encode\n", faults, count, kind);
}

static void test_encode_opencl(void **state) {
    (void)state;
    sweep_encodes(GSCL_PROFILE_DEFAULT, FAULT_OPENCL, false);
}

static void test_encode_codebooks_opencl(void **state) {
    (void)state;
    sweep_encodes(GSCL_PROFILE_PAPER, FAULT_OPENCL, false);
}

static void test_encode_finish(void **state) {
    (void)state;
    sweep_encodes(GSCL_PROFILE_DEFAULT, FAULT_FINISH, true);
}

static void test_encode_memory(void **state) {
    (void)state;
    sweep_encodes(GSCL_PROFILE_DEFAULT, FAULT_MEMORY, false);
    sweep_encodes(GSCL_PROFILE_PAPER, FAULT_MEMORY, true);
}

/* ---- Opening a device, and reading without one ---------------------------------------------------- */

static void sweep_contexts(fault_kind kind) {
    const char *device = first_opencl_device();
    bool reached = true;
    int number = 1;
    for (; reached; number++) {
        gscl_context *context;
        const int live = fault_live_blocks();
        faults_begin(kind, number, false);
        const gscl_result result = create_context(&context, device);
        reached = faults_end(kind) >= number;
        assert_explained(context, result, kind, number);
        gscl_context_free(&context);
        assert_int_equal(fault_live_blocks(), live);
    }
    assert_true(number > 4);
}

static void test_context(void **state) {
    (void)state;
    sweep_contexts(FAULT_MEMORY);
    sweep_contexts(FAULT_OPENCL);
}

static gscl_result list_devices(void) {
    gscl_device_info *devices = NULL;
    const gscl_result result = gscl_list_devices(&devices);
    gscl_free(devices);
    return result;
}

static gscl_result inspect(void) {
    gscl_info info = {.struct_size = sizeof info};
    return gscl_inspect(file, file_size, NULL, &info);
}

static gscl_result read_field(void) {
    gscl_field field = {.struct_size = sizeof field};
    const gscl_result result = gscl_read_field(file, file_size, NULL, &field);
    gscl_free(field.splats);
    return result;
}

static gscl_result inspect_effects(void) {
    gscl_effect_use uses[GSCL_EFFECT_COUNT];
    size_t count;
    return gscl_inspect_effects(NULL, file, file_size, NULL, NULL, uses, &count);
}

static gscl_result certain_splats(void) {
    uint32_t certain, total;
    return gscl_certain_splats(file, file_size, NULL, &certain, &total);
}

/* Functions without a context have the text of their result. */
static void test_reading(void **state) {
    gscl_result (*const functions[])(void) = {list_devices, inspect, read_field, inspect_effects, certain_splats};
    (void)state;
    for (size_t i = 0; i < sizeof functions / sizeof *functions; i++) {
        const int live = fault_live_blocks();
        bool reached = true;
        for (int number = 1; reached; number++) {
            faults_begin(FAULT_MEMORY, number, false);
            const gscl_result result = functions[i]();
            reached = faults_end(FAULT_MEMORY) >= number;
            assert_explained(NULL, result, FAULT_MEMORY, number);
            assert_true(reached || result == GSCL_OK);
            assert_int_equal(fault_live_blocks(), live);
        }
    }
}

/* ---- All --------------------------------------------------------------------------------------- */

static int make_file(void **state) {
    (void)state;
    gscl_context *context;
    gscl_result result = create_context(&context, first_opencl_device());
    if (result == GSCL_OK)
        result = encode(context, GSCL_PROFILE_DEFAULT, &file, &file_size);
    gscl_context_free(&context);
    return result == GSCL_OK ? 0 : -1;
}

static int free_file(void **state) {
    (void)state;
    gscl_free(file);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_decode_opencl),
        cmocka_unit_test(test_decode_opencl_rows_with_gaps),
        cmocka_unit_test(test_decode_buffers),
        cmocka_unit_test(test_decode_lost_device),
        cmocka_unit_test(test_decode_memory),
        cmocka_unit_test(test_encode_opencl),
        cmocka_unit_test(test_encode_codebooks_opencl),
        cmocka_unit_test(test_encode_finish),
        cmocka_unit_test(test_encode_memory),
        cmocka_unit_test(test_context),
        cmocka_unit_test(test_reading),
    };
    opencl_faults_install();
    return cmocka_run_group_tests(tests, make_file, free_file);
}
