/* A context for all tests of a program, on the device that GSCL_TEST_DEVICE names or else the default device.  Programs that
 * test kernels define TESTS_KERNELS: else is the first OpenCL device. */
#ifndef GSCL_ONE_CONTEXT_H
#define GSCL_ONE_CONTEXT_H

#include "devices.h"

static gscl_context *context;

static int open_context(void **state) {
    (void)state;
#ifdef TESTS_KERNELS
    return open_on(&context, kernel_test_device(), GSCL_MAPPING_AUTO) ? 0 : -1;
#else
    return open_on(&context, test_device(), GSCL_MAPPING_AUTO) ? 0 : -1;
#endif
}

static int close_context(void **state) {
    (void)state;
    gscl_context_free(&context);
    return context ? -1 : 0;
}

#endif
