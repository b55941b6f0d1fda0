/* Which images of a batch are encoded alone on a device: those that are large for its memory. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>
#include <gscl/gscl.h>

#include "commands/batch_devices.h"

#define GIB ((uint64_t)1 << 30)
#define MEGAPIXEL ((uint64_t)1000000)
#define JOBS 3

static void test_large_images_depend_on_the_memory(void **state) {
    (void)state;
    gscl_device_info info = {.memory_bytes = 80 * GIB};
    assert_true(batch_shared_pixels(&info, 8) > 25 * MEGAPIXEL);
    assert_true(batch_shared_pixels(&info, 1) >= 8 * batch_shared_pixels(&info, 8));
    info.memory_bytes = 8 * GIB;
    assert_true(batch_shared_pixels(&info, 2) > 4 * MEGAPIXEL);
    assert_true(batch_shared_pixels(&info, 8) < 25 * MEGAPIXEL);
    info.memory_bytes = 0;
    assert_int_equal(batch_shared_pixels(&info, 1), 0);
    assert_int_equal(batch_shared_pixels(NULL, 1), 0);
}

/* A device of JOBS workers, which compiled its kernels with an image before. */
typedef struct device_of_a_batch {
    batch_devices devices;
    batch_device device;
    batch_worker workers[JOBS];
} device_of_a_batch;

static void make_device(device_of_a_batch *b, uint64_t shared_pixels) {
    *b = (device_of_a_batch){
        .devices = {.count = 1, .lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER},
        .device = {.worker_count = JOBS, .shared_pixels = shared_pixels, .finished = 1}};
    b->devices.devices = &b->device;
    b->device.workers = b->workers;
    for (int k = 0; k < JOBS; k++)
        b->workers[k] = (batch_worker){.batch = &b->devices, .device = &b->device};
}

static batch_worker *begin(device_of_a_batch *b, uint32_t width, uint32_t height) {
    const gscl_image image = {.width = width, .height = height};
    batch_worker *worker = batch_devices_idle(&b->devices);
    assert_non_null(worker);
    batch_worker_begin(worker, &image);
    return worker;
}

/* Begins an image beside which the device takes no other. */
static batch_worker *begin_alone(device_of_a_batch *b, uint32_t width, uint32_t height) {
    batch_worker *worker = begin(b, width, height);
    assert_null(batch_devices_idle(&b->devices));
    return worker;
}

static void test_small_images_share_a_device(void **state) {
    (void)state;
    device_of_a_batch b;
    make_device(&b, 4 * MEGAPIXEL);
    for (int k = 0; k < JOBS; k++)
        begin(&b, 2000, 2000);
    assert_null(batch_devices_idle(&b.devices));
    batch_worker_end(&b.workers[1]);
    assert_ptr_equal(batch_devices_idle(&b.devices), &b.workers[1]);
}

static void test_a_large_image_is_alone(void **state) {
    (void)state;
    device_of_a_batch b;
    make_device(&b, 4 * MEGAPIXEL);
    batch_worker_end(begin_alone(&b, 2000, 2001));
    begin(&b, 100, 100);
    assert_non_null(batch_devices_idle(&b.devices));
}

/* More pixels than 32 bits count, which would be 0. */
static void test_pixels_are_counted_in_64_bits(void **state) {
    (void)state;
    device_of_a_batch b;
    make_device(&b, 4 * MEGAPIXEL);
    begin_alone(&b, 65536, 65536);
}

static void test_the_first_image_compiles_alone(void **state) {
    (void)state;
    device_of_a_batch b;
    make_device(&b, 4 * MEGAPIXEL);
    b.device.finished = 0;
    begin_alone(&b, 100, 100);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_large_images_depend_on_the_memory),
        cmocka_unit_test(test_small_images_share_a_device),
        cmocka_unit_test(test_a_large_image_is_alone),
        cmocka_unit_test(test_pixels_are_counted_in_64_bits),
        cmocka_unit_test(test_the_first_image_compiles_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
