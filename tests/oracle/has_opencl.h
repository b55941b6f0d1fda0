/* For programs of which some tests need OpenCL, and the others only a library that decodes.  After cmocka.h. */
#ifndef GSCL_HAS_OPENCL_H
#define GSCL_HAS_OPENCL_H

#include <gscl/gscl.h>
#include <string.h>

/* Whether the library was built with OpenCL.  Where it was, and there is no device, opening a context fails. */
static inline bool has_opencl(void) {
    gscl_device_info *devices = NULL;
    const gscl_result result = gscl_list_devices(&devices);
    gscl_free(devices);
    return result != GSCL_ERROR_NO_ENCODER;
}

#define MAX_TESTS 100

/* Runs tests, and those that need OpenCL where the library has it, as one group. */
static inline int run_joined_tests(const struct CMUnitTest *tests, size_t count, const struct CMUnitTest *opencl_tests,
                                   size_t opencl_count, CMFixtureFunction set_up, CMFixtureFunction tear_down) {
    struct CMUnitTest all[MAX_TESTS];
    if (count + opencl_count > MAX_TESTS)
        return -1;
    memcpy(all, tests, count * sizeof *all);
    memcpy(all + count, opencl_tests, opencl_count * sizeof *all);
    return _cmocka_run_group_tests("tests", all, count + (has_opencl() ? opencl_count : 0), set_up, tear_down);
}

/* The same for two arrays. */
#define RUN_WITH_OPENCL_TESTS(tests, opencl_tests, set_up, tear_down)      \
    run_joined_tests(tests, sizeof(tests) / sizeof *(tests), opencl_tests, \
                     sizeof(opencl_tests) / sizeof *(opencl_tests), set_up, tear_down)

#endif
