#include "device/host_device.h"

#include "runtime/stage_clock.h"

gscl_result gscl_host_open(gscl_context *context, const gscl_context_settings *settings) {
    context->is_host = context->is_cpu = true;
    context->info = (gscl_device_info){.id = GSCL_HOST_DEVICE,
                                       .platform_name = "gscl",
                                       .device_name = "decoder without kernels",
                                       .device_version = "gscl " GSCL_VERSION,
                                       .compute_units = 1};
    return settings->timing ? gscl_timing_create(context) : GSCL_OK;
}
