/* Eight threads, each with a context of its own, encode, decode and inspect at the same time, and get what one thread alone
 * gets; a library without an encoder decodes and inspects.  tests/check_threads.sh runs this with ThreadSanitizer. */
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>

#include "devices.h"
#include "joined_tests.h"
#include "synthetic_scene.h"

#define THREADS 8
#define ROUNDS 3
#define WIDTH 40
#define HEIGHT 24
#define SPLATS 6

/* What a thread makes: a file, and the pixels that its file shows. */
typedef struct product {
    const char *device;
    const uint8_t *file; /* to decode; NULL: encodes, too */
    size_t file_size;
    uint8_t *bytes;
    size_t size;
    uint8_t pixels[3 * WIDTH * HEIGHT];
    gscl_info info;
    gscl_result result;
} product;

static gscl_result encode(gscl_context *context, product *made) {
    uint8_t pixels[3 * WIDTH * HEIGHT];
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++)
        pixels[i] = (uint8_t)(i / 3 % WIDTH * 5 + i / WIDTH);
    const gscl_image image = {
        .width = WIDTH, .height = HEIGHT, .channels = 3, .sample = GSCL_SAMPLE_U8, .pixels = pixels};
    gscl_encode_settings settings;
    gscl_encode_settings_default(&settings);
    settings.effort = 0;
    settings.target = GSCL_TARGET_SPLATS;
    settings.target_value = SPLATS;
    return gscl_encode(context, &image, &settings, &made->bytes, &made->size, NULL);
}

static gscl_result decode(gscl_context *context, product *made) {
    gscl_image image = {.pixels = NULL};
    const uint8_t *file = made->file ? made->file : made->bytes;
    const size_t size = made->file ? made->file_size : made->size;
    made->info = (gscl_info){.struct_size = sizeof made->info};
    gscl_result result = gscl_inspect(file, size, NULL, &made->info);
    if (result == GSCL_OK)
        result = gscl_decode(context, file, size, NULL, &image);
    if (result == GSCL_OK)
        memcpy(made->pixels, image.pixels, sizeof made->pixels);
    gscl_free(image.pixels);
    return result;
}

static gscl_result make(product *made) {
    gscl_context *context;
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    settings.device = made->device;
    gscl_result result = gscl_context_create(&context, &settings);
    for (int round = 0; round < ROUNDS && result == GSCL_OK; round++) {
        gscl_free(made->bytes);
        made->bytes = NULL;
        if (!made->file)
            result = encode(context, made);
        if (result == GSCL_OK)
            result = decode(context, made);
    }
    gscl_context_free(&context);
    return result;
}

static void *run_thread(void *opaque) {
    product *made = opaque;
    made->result = make(made);
    return NULL;
}

static void assert_equal(const product *made, const product *expected) {
    assert_int_equal(made->result, GSCL_OK);
    assert_int_equal(made->size, expected->size);
    if (expected->size > 0)
        assert_memory_equal(made->bytes, expected->bytes, expected->size);
    assert_memory_equal(made->pixels, expected->pixels, sizeof expected->pixels);
    assert_int_equal(made->info.splats, expected->info.splats);
}

/* Eight threads make what was made before. */
static void run_threads(const product *expected) {
    product *made = calloc(THREADS, sizeof *made);
    pthread_t threads[THREADS];
    assert_non_null(made);
    for (int i = 0; i < THREADS; i++) {
        made[i] = (product){.device = expected->device, .file = expected->file, .file_size = expected->file_size};
        assert_int_equal(pthread_create(&threads[i], NULL, run_thread, &made[i]), 0);
    }
    for (int i = 0; i < THREADS; i++)
        assert_int_equal(pthread_join(threads[i], NULL), 0);
    for (int i = 0; i < THREADS; i++) {
        assert_equal(&made[i], expected);
        gscl_free(made[i].bytes);
    }
    free(made);
}

static void encode_in_threads(const char *device) {
    product expected = {.device = device};
    assert_int_equal(make(&expected), GSCL_OK);
    run_threads(&expected);
    gscl_free(expected.bytes);
}

static void test_opencl(void **state) {
    (void)state;
    encode_in_threads(first_opencl_device());
}

static void test_native(void **state) {
    (void)state;
    encode_in_threads(GSCL_HOST_DEVICE);
}

static void test_decoding_on_host(void **state) {
    (void)state;
    uint8_t *file;
    size_t size;
    assert_true(synthetic_file(WIDTH, HEIGHT, SPLATS, &file, &size));
    product expected = {.device = GSCL_HOST_DEVICE, .file = file, .file_size = size};
    assert_int_equal(make(&expected), GSCL_OK);
    run_threads(&expected);
    free(file);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_decoding_on_host),
    };
    const struct CMUnitTest native_tests[] = {cmocka_unit_test(test_native)};
    const struct CMUnitTest opencl_tests[] = {cmocka_unit_test(test_opencl)};
    JOIN_TESTS(tests);
    if (has_native())
        JOIN_TESTS(native_tests);
    if (has_opencl())
        JOIN_TESTS(opencl_tests);
    return run_joined_tests(NULL, NULL);
}
