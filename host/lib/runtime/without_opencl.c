/* What a library without OpenCL (meson setup -Dopencl=disabled) has in place of open_device.c, device.c and timing.c. */
#include <gscl/measure.h>
#include <stddef.h>

#include "runtime/open_device.h"
#include "runtime/stage_clock.h"

const char *const gscl_default_device = GSCL_HOST_DEVICE;

gscl_result gscl_device_open(gscl_context *context, const gscl_context_settings *settings) {
    return gscl_fail(context, GSCL_ERROR_NO_OPENCL,
                     "the device \"%.60s\" cannot be used: this library was built without OpenCL and has the device "
                     "\"host\" only",
                     settings->device);
}

void gscl_device_close(gscl_context *context) {
    (void)context;
}

/* Nothing is measured. */
gscl_result gscl_timing_create(gscl_context *context) {
    (void)context;
    return GSCL_OK;
}

gscl_result gscl_list_devices(gscl_device_info **devices) {
    return devices ? GSCL_ERROR_NO_OPENCL : GSCL_ERROR_INVALID_ARGUMENT;
}

const gscl_timing *gscl_context_timings(const gscl_context *context) {
    (void)context;
    return NULL;
}

void gscl_context_reset_timings(gscl_context *context) {
    (void)context;
}
