/* What a library with neither OpenCL nor compiled kernels (meson setup -Dopencl=disabled -Dnative=disabled) has in place of
 * open_device.c and device_list.c. */
#include <stddef.h>
#include <string.h>

#include "device/host_device.h"
#include "device/open_device.h"
#include "runtime/timing.h"

gscl_result gscl_device_open(gscl_context *context, const gscl_context_settings *settings) {
    if (!settings->device || strcmp(settings->device, GSCL_HOST_DEVICE) == 0)
        return gscl_host_open(context, settings);
    return gscl_fail(context, GSCL_ERROR_NO_ENCODER,
                     "the device \"%.60s\" cannot be used: this library was built without OpenCL and has the device "
                     "\"host\" only",
                     settings->device);
}

void gscl_device_close(gscl_context *context) {
    gscl_timing_free(context);
}

gscl_result gscl_list_devices(gscl_device_info **devices) {
    return devices ? GSCL_ERROR_NO_ENCODER : GSCL_ERROR_INVALID_ARGUMENT;
}
