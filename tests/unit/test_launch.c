/* Launches that fail, with opencl/launch.c compiled with its debug checks. */
#include <limits.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>

#include "devices.h"
#include "fake_opencl.h"
#include "opencl/build_options.h"
#include "opencl/cl_error.h"
#include "runtime/buffer.h"
#include "runtime/launch.h"
#include "runtime/mapping.h"
#include "runtime/queue.h"

static int open_context(void **state) {
    gscl_context *context;
    const bool opened = open_on(&context, first_opencl_device(), GSCL_MAPPING_AUTO);
    *state = context;
    return opened ? 0 : -1;
}

static int fake_nothing(void **state) {
    (void)state;
    fake = (fake_opencl){0};
    return 0;
}

static int close_context(void **state) {
    gscl_context *context = *state;
    gscl_context_free(&context);
    return 0;
}

static const gscl_kernel_options plain = {.colours = 1};

/* Launches `multiply_add`, which takes a factor and a buffer, with the first `count` arguments. */
static gscl_result launch(gscl_context *context, size_t count) {
    gscl_kernel *kernel;
    gscl_buffer sums = {0};
    float factor = 1;
    assert_int_equal(gscl_kernel_find(context, GSCL_PROGRAM_BENCHMARK, &plain, "multiply_add", &kernel), GSCL_OK);
    assert_int_equal(gscl_buffer_reserve(context, &sums, 65536), GSCL_OK);
    const gscl_argument arguments[] = {GSCL_ARG(factor), GSCL_ARG_BUFFER(sums), GSCL_ARG(factor)};
    const gscl_result result = gscl_launch_(context, kernel, 1, 64, arguments, count);
    assert_int_equal(gscl_finish(context), GSCL_OK);
    gscl_buffer_free(&sums);
    return result;
}

static void test_right_arguments(void **state) {
    assert_int_equal(launch(*state, 2), GSCL_OK);
}

/* OpenCL does not notice a missing argument when an earlier launch has set it. */
static void test_wrong_number_of_arguments(void **state) {
    gscl_context *context = *state;
    assert_int_equal(launch(context, 2), GSCL_OK);
    assert_int_equal(launch(context, 1), GSCL_ERROR_DEVICE_FAILED);
    assert_string_equal(gscl_context_message(context), "kernel multiply_add takes 2 arguments, it was launched with 1");
    assert_int_equal(launch(context, 3), GSCL_ERROR_DEVICE_FAILED);
}

static void test_failed_launch_names_its_kernel(void **state) {
    gscl_context *context = *state;
    fake.launch_error = CL_INVALID_WORK_GROUP_SIZE;
    assert_int_equal(launch(context, 2), GSCL_ERROR_DEVICE_FAILED);
    assert_non_null(strstr(gscl_context_message(context), "kernel multiply_add on "));
    assert_non_null(strstr(gscl_context_message(context), "CL_INVALID_WORK_GROUP_SIZE (-54)"));
}

/* As where a kernel takes more registers than a group of its size has: the launch would fail without saying why. */
static void test_too_small_groups_name_the_kernel(void **state) {
    gscl_context *context = *state;
    char expected[256];
    gscl_kernel *kernel;
    fake.largest_kernel_group = 32;
    assert_int_equal(gscl_kernel_find(context, GSCL_PROGRAM_BENCHMARK, &plain, "copy", &kernel), GSCL_ERROR_GROUP_SIZE);
    snprintf(expected, sizeof expected,
             "%s runs the kernel copy in work-groups of at most 32 work-items, and it needs 64",
             gscl_context_device(context)->device_name);
    assert_string_equal(gscl_context_message(context), expected);
    fake.largest_kernel_group = 64;
    assert_int_equal(gscl_kernel_find(context, GSCL_PROGRAM_BENCHMARK, &plain, "copy", &kernel), GSCL_OK);
}

/* Kernels that visit splats run in the largest groups, at most 256 and at least 32 work-items, that the device has registers for. */
static void test_visits_take_groups_that_fit(void **state) {
    const gscl_kernel_options of_an_image = {.colours = 3};
    gscl_context *context;
    gscl_kernel *kernel;
    (void)state;
    assert_true(open_on(&context, first_opencl_device(), GSCL_MAPPING_GPU));
    assert_int_equal(gscl_rdo_group_size(context), 256);
    fake.largest_kernel_group = 100;
    assert_int_equal(gscl_kernel_find(context, GSCL_PROGRAM_SCALAR_RDO, &of_an_image, "rdo_visit", &kernel), GSCL_OK);
    assert_int_equal(gscl_rdo_group_size(context), 64);
    fake.largest_kernel_group = 31;
    assert_int_equal(gscl_kernel_find(context, GSCL_PROGRAM_SCALAR_RDO, &of_an_image, "rdo_begin", &kernel),
                     GSCL_ERROR_GROUP_SIZE);
    assert_int_equal(gscl_rdo_group_size(context), 32);
    fake.largest_kernel_group = 0;
    gscl_context_free(&context);
}

static void test_resources_are_not_memory(void **state) {
    gscl_context *context = *state;
    fake.launch_error = CL_OUT_OF_RESOURCES;
    assert_int_equal(launch(context, 2), GSCL_ERROR_DEVICE_FAILED);
    assert_non_null(strstr(gscl_context_message(context), "ran out of resources"));
    assert_null(strstr(gscl_context_message(context), "memory"));
    fake.launch_error = CL_MEM_OBJECT_ALLOCATION_FAILURE;
    assert_int_equal(launch(context, 2), GSCL_ERROR_DEVICE_MEMORY);
}

/* The codes of OpenCL 1.2 are -1..-19 and -30..-68. */
static void test_every_error_has_a_name(void **state) {
    (void)state;
    for (int32_t error = -1; error >= -68; error--) {
        const bool defined = error >= -19 || error <= -30;
        assert_int_equal(strncmp(gscl_cl_error_name(error), "CL_", 3) == 0, defined);
        for (int32_t other = -1; defined && other > error; other--)
            assert_string_not_equal(gscl_cl_error_name(error), gscl_cl_error_name(other));
    }
}

static void test_long_build_options_are_refused(void **state) {
    gscl_context *context = *state;
    char text[GSCL_MAX_BUILD_OPTIONS];
    const gscl_kernel_options longest = {INT_MIN, INT_MIN, INT_MIN, INT_MIN, INT_MIN, INT_MIN,
                                         INT_MIN, INT_MIN, 1e300,   INT_MIN, 1e300,   1};
    assert_int_equal(gscl_build_options(context, GSCL_PROGRAM_FIT, &plain, text), GSCL_OK);
    assert_non_null(strstr(text, " -DCOLOURS=1 "));
    assert_int_equal(gscl_build_options(context, GSCL_PROGRAM_FIT, &longest, text), GSCL_ERROR_KERNEL_BUILD);
    assert_non_null(strstr(gscl_context_message(context), "build options"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_right_arguments, fake_nothing),
        cmocka_unit_test_setup(test_wrong_number_of_arguments, fake_nothing),
        cmocka_unit_test_setup(test_failed_launch_names_its_kernel, fake_nothing),
        cmocka_unit_test_setup(test_too_small_groups_name_the_kernel, fake_nothing),
        cmocka_unit_test_setup(test_visits_take_groups_that_fit, fake_nothing),
        cmocka_unit_test_setup(test_resources_are_not_memory, fake_nothing),
        cmocka_unit_test_setup(test_every_error_has_a_name, fake_nothing),
        cmocka_unit_test_setup(test_long_build_options_are_refused, fake_nothing),
    };
    fake_opencl_install();
    return cmocka_run_group_tests(tests, open_context, close_context);
}
