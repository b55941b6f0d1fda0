/* What the library has that a test is linked with, and the devices that tests run on. */
#ifndef GSCL_TESTS_DEVICES_H
#define GSCL_TESTS_DEVICES_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gscl/gscl.h>

/* Whether the library was built with OpenCL.  Where it was, and there is no device, opening a context fails. */
static inline bool has_opencl(void) {
#ifdef GSCL_WITH_OPENCL
    return true;
#else
    return false;
#endif
}

/* Whether the library was built with kernels for the processor. */
static inline bool has_native(void) {
#ifdef GSCL_WITH_NATIVE
    return true;
#else
    return false;
#endif
}

/* Whether the library was built to encode. */
static inline bool has_encoder(void) {
    return has_opencl() || has_native();
}

/* The selector of the first OpenCL device; "0.0", which cannot be opened, where there is none. */
static inline const char *first_opencl_device(void) {
    static char id[sizeof((gscl_device_info *)NULL)->id];
    gscl_device_info *devices = NULL;
    snprintf(id, sizeof id, "0.0");
    if (gscl_list_devices(&devices) == GSCL_OK && strcmp(devices->id, GSCL_HOST_DEVICE) != 0)
        snprintf(id, sizeof id, "%s", devices->id);
    gscl_free(devices);
    return id;
}

/* The selector in GSCL_TEST_DEVICE; NULL, for the default device, where it is not set. */
static inline const char *test_device(void) {
    return getenv("GSCL_TEST_DEVICE");
}

/* The same for tests of kernels, which run on the first OpenCL device where it is not set. */
static inline const char *kernel_test_device(void) {
    return test_device() ? test_device() : first_opencl_device();
}

/* Opens a context on a device, with a mapping.  Returns whether that succeeded. */
static inline bool open_on(gscl_context **context, const char *device, gscl_mapping mapping) {
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    settings.device = device;
    settings.mapping = mapping;
    return gscl_context_create(context, &settings) == GSCL_OK;
}

#endif
