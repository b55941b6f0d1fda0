/* Large results of a device with memory of its own, which the real device plays, and work that begins early. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>

#include "devices.h"
#include "fake_opencl.h"
#include "opencl/tunables.h"
#include "runtime/buffer.h"
#include "runtime/queue.h"

enum { ROW = 1013, ROWS = 10007, STRIDE = 1024, SIZE = ROW * ROWS }; /* bytes: more than the two halves */

static uint8_t source[SIZE], read[STRIDE * ROWS];

static gscl_context *open_fake(bool shares_memory, cl_device_type type) {
    gscl_context *context;
    fake = (fake_opencl){.device_type = type,
                         .first = {.is_read = true, .shares_memory = shares_memory, .memory = 1 << 30, .units = 2}};
    assert_true(open_on(&context, first_opencl_device(), GSCL_MAPPING_AUTO));
    return context;
}

static gscl_buffer buffer_of_source(gscl_context *context) {
    gscl_buffer buffer = {0};
    assert_true(SIZE > 2 * gscl_opencl_tunables.pinned_half);
    for (size_t i = 0; i < SIZE; i++)
        source[i] = (uint8_t)(i % 251 + i / 65536);
    assert_int_equal(gscl_buffer_reserve(context, &buffer, SIZE), GSCL_OK);
    assert_int_equal(gscl_buffer_write(context, &buffer, 0, source, SIZE), GSCL_OK);
    return buffer;
}

static void check_read(gscl_context *context, const gscl_buffer *buffer, size_t offset, size_t size) {
    memset(read, 0xEE, sizeof read);
    assert_int_equal(gscl_buffer_read(context, buffer, offset, read, size), GSCL_OK);
    assert_memory_equal(read, source + offset, size);
    assert_int_equal(read[size], 0xEE);
}

static void check_read_rows(gscl_context *context, const gscl_buffer *buffer) {
    memset(read, 0xEE, sizeof read);
    assert_int_equal(gscl_buffer_read_rows(context, buffer, ROW, ROWS, read, STRIDE), GSCL_OK);
    for (size_t y = 0; y < ROWS; y++) {
        assert_memory_equal(read + y * STRIDE, source + y * ROW, ROW);
        assert_int_equal(read[y * STRIDE + ROW], 0xEE);
    }
}

static void check_reads(gscl_context *context, int maps) {
    gscl_buffer buffer = buffer_of_source(context);
    const size_t half = gscl_opencl_tunables.pinned_half;
    check_read(context, &buffer, 5, gscl_opencl_tunables.pinned_least - 1);
    assert_int_equal(fake.maps, 0);
    check_read(context, &buffer, 0, SIZE);
    check_read(context, &buffer, 12345, half);
    check_read(context, &buffer, 7, half + 1);
    check_read_rows(context, &buffer);
    assert_int_equal(fake.maps, maps);
    gscl_buffer_free(&buffer);
    gscl_context_free(&context);
}

static void test_large_reads_are_pinned(void **state) {
    (void)state;
    check_reads(open_fake(false, CL_DEVICE_TYPE_GPU), 1);
}

static void test_shared_memory_is_read_at_once(void **state) {
    (void)state;
    check_reads(open_fake(true, CL_DEVICE_TYPE_GPU), 0);
}

static void test_cpus_are_read_at_once(void **state) {
    (void)state;
    check_reads(open_fake(false, CL_DEVICE_TYPE_CPU), 0);
}

static void test_reads_do_without_pinned_memory(void **state) {
    (void)state;
    gscl_context *context = open_fake(false, CL_DEVICE_TYPE_GPU);
    fake.map_error = CL_MAP_FAILURE;
    check_reads(context, 1);
}

static void test_work_begins_early(void **state) {
    (void)state;
    gscl_context *context = open_fake(true, CL_DEVICE_TYPE_GPU);
    gscl_buffer buffer = buffer_of_source(context);
    gscl_flush(context); /* there is none after a blocking copy */
    assert_int_equal(fake.flushes, 0);
    assert_int_equal(gscl_buffer_zero(context, &buffer, 0, SIZE / 4 * 4), GSCL_OK);
    gscl_flush(context);
    assert_int_equal(fake.flushes, 1);
    gscl_buffer_free(&buffer);
    gscl_context_free(&context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_large_reads_are_pinned), cmocka_unit_test(test_shared_memory_is_read_at_once),
        cmocka_unit_test(test_cpus_are_read_at_once),  cmocka_unit_test(test_reads_do_without_pinned_memory),
        cmocka_unit_test(test_work_begins_early),
    };
    fake_opencl_install();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
