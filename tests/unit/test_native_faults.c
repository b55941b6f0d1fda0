/* On the device "host" each allocation fails once, and each start of a thread, in encodes, in a decode with kernels and when a
 * context is created.  Without memory the result is GSCL_ERROR_OUT_OF_MEMORY, without threads the same file is made by fewer of
 * them; nothing is leaked, and the context works afterwards. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>

#include "faults.h"
#include "native/launch.h"

#define WIDTH 40
#define HEIGHT 24
#define SPLATS 6
#define THREADS 3
#define DECODED_SCALE 12 /* of a decode: beyond what is drawn in software */

typedef struct file {
    uint8_t *bytes;
    size_t size;
} file;

static gscl_result create_context(gscl_context **context) {
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    settings.device = GSCL_HOST_DEVICE;
    settings.threads = THREADS;
    return gscl_context_create(context, &settings);
}

static gscl_context *open_host(void) {
    gscl_context *context;
    assert_int_equal(create_context(&context), GSCL_OK);
    return context;
}

static gscl_result encode(gscl_context *context, gscl_profile profile, file *f) {
    uint8_t pixels[3 * WIDTH * HEIGHT];
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++)
        pixels[i] = (uint8_t)(i / 3 % WIDTH * 5 + i / WIDTH);
    const gscl_image image = {
        .width = WIDTH, .height = HEIGHT, .channels = 3, .sample = GSCL_SAMPLE_U8, .pixels = pixels};
    gscl_encode_settings settings;
    gscl_encode_settings_default(&settings);
    settings.profile = profile;
    settings.effort = 0;
    settings.target = GSCL_TARGET_SPLATS;
    settings.target_value = SPLATS;
    *f = (file){NULL, 0};
    return gscl_encode(context, &image, &settings, &f->bytes, &f->size, NULL);
}

static void assert_same(const file *f, const file *expected) {
    assert_int_equal(f->size, expected->size);
    assert_memory_equal(f->bytes, expected->bytes, f->size);
}

static void assert_no_memory(const gscl_context *context, gscl_result result, int number) {
    if (result != GSCL_ERROR_OUT_OF_MEMORY)
        fail_msg("allocation %d (%s): result %d", number, fault_call(), (int)result);
    assert_true(!context || strstr(gscl_context_message(context), "memory"));
}

/* ---- Encodes --------------------------------------------------------------------------------------- */

/* One with a fault, and one after it in the same context.  Returns whether the fault was reached. */
static bool encode_with_fault(gscl_context *context, gscl_profile profile, int number, bool forever,
                              const file *expected) {
    file f;
    faults_begin(FAULT_MEMORY, number, forever);
    const gscl_result result = encode(context, profile, &f);
    const bool reached = faults_end(FAULT_MEMORY) >= number;
    if (result == GSCL_OK)
        assert_same(&f, expected); /* a block that is not made smaller has no consequence */
    else
        assert_no_memory(context, result, number);
    assert_true(result == GSCL_OK || (reached && !f.bytes));
    gscl_free(f.bytes);
    assert_int_equal(encode(context, profile, &f), GSCL_OK);
    assert_same(&f, expected);
    gscl_free(f.bytes);
    return reached;
}

/* Each fault in a context of its own, which has encoded before if `is_used`: then it has allocated some memory already. */
static void sweep_memory(gscl_profile profile, bool forever, bool is_used) {
    const int live = fault_live_blocks();
    file expected, f;
    bool reached = true;
    int number = 1;
    gscl_context *context = open_host();
    assert_int_equal(encode(context, profile, &expected), GSCL_OK);
    gscl_context_free(&context);
    for (; reached; number++) {
        context = open_host();
        if (is_used) {
            assert_int_equal(encode(context, profile, &f), GSCL_OK);
            gscl_free(f.bytes);
        }
        reached = encode_with_fault(context, profile, number, forever, &expected);
        gscl_context_free(&context);
    }
    gscl_free(expected.bytes);
    assert_true(number > 30);
    assert_int_equal(fault_live_blocks(), live);
    print_message("# %d allocations in an encode\n", number - 2);
}

static void test_memory_of_encodes(void **state) {
    (void)state;
    sweep_memory(GSCL_PROFILE_DEFAULT, false, false);
    sweep_memory(GSCL_PROFILE_DEFAULT, true, true);
}

static void test_memory_of_codebooks(void **state) {
    (void)state;
    sweep_memory(GSCL_PROFILE_PAPER, false, false);
}

static void test_threads(void **state) {
    (void)state;
    const int live = fault_live_blocks();
    file expected, f;
    gscl_context *context = open_host();
    faults_begin(FAULT_THREAD, 0, false);
    assert_int_equal(encode(context, GSCL_PROFILE_DEFAULT, &expected), GSCL_OK);
    assert_int_equal(faults_end(FAULT_THREAD), THREADS - 1);
    gscl_context_free(&context);
    for (int number = 1; number < 2 * THREADS - 1; number++) {
        context = open_host();
        faults_begin(FAULT_THREAD, 1 + number / 2, number % 2);
        for (int again = 0; again < 2; again++) {
            assert_int_equal(encode(context, GSCL_PROFILE_DEFAULT, &f), GSCL_OK);
            assert_same(&f, &expected);
            gscl_free(f.bytes);
        }
        faults_end(FAULT_THREAD);
        gscl_context_free(&context);
    }
    gscl_free(expected.bytes);
    assert_int_equal(fault_live_blocks(), live);
}

/* ---- Decodes and contexts -------------------------------------------------------------------------- */

static gscl_result decode(gscl_context *context, const file *f, gscl_image *image) {
    gscl_decode_settings settings;
    gscl_decode_settings_default(&settings);
    settings.width = DECODED_SCALE * WIDTH;
    settings.height = DECODED_SCALE * HEIGHT;
    *image = (gscl_image){0};
    return gscl_decode(context, f->bytes, f->size, &settings, image);
}

static void test_memory_of_decodes(void **state) {
    (void)state;
    const int live = fault_live_blocks();
    const size_t pixels = (size_t)3 * DECODED_SCALE * WIDTH * DECODED_SCALE * HEIGHT;
    gscl_context *context = open_host();
    gscl_image expected, image;
    file f;
    assert_int_equal(encode(context, GSCL_PROFILE_DEFAULT, &f), GSCL_OK);
    assert_int_equal(decode(context, &f, &expected), GSCL_OK);
    gscl_context_free(&context);
    bool reached = true;
    int number = 1;
    for (; reached; number++) {
        context = open_host();
        faults_begin(FAULT_MEMORY, number, false);
        const gscl_result result = decode(context, &f, &image);
        reached = faults_end(FAULT_MEMORY) >= number;
        if (result == GSCL_OK)
            assert_memory_equal(image.pixels, expected.pixels, pixels);
        else
            assert_no_memory(context, result, number);
        gscl_free(image.pixels);
        assert_int_equal(decode(context, &f, &image), GSCL_OK);
        assert_memory_equal(image.pixels, expected.pixels, pixels);
        gscl_free(image.pixels);
        gscl_context_free(&context);
    }
    assert_true(number > 10);
    gscl_free(expected.pixels);
    gscl_free(f.bytes);
    assert_int_equal(fault_live_blocks(), live);
}

static void test_memory_of_contexts(void **state) {
    (void)state;
    bool reached = true;
    int number = 1;
    for (; reached; number++) {
        const int live = fault_live_blocks();
        gscl_context *context;
        faults_begin(FAULT_MEMORY, number, false);
        const gscl_result result = create_context(&context);
        reached = faults_end(FAULT_MEMORY) >= number;
        if (result != GSCL_OK)
            assert_no_memory(context, result, number);
        gscl_context_free(&context);
        assert_int_equal(fault_live_blocks(), live);
    }
    assert_true(number > 3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_memory_of_encodes),
        cmocka_unit_test(test_memory_of_codebooks),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_memory_of_decodes),
        cmocka_unit_test(test_memory_of_contexts),
    };
    gscl_native_all_threads = true;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
