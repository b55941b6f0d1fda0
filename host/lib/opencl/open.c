#include "opencl/open.h"

#include <stdlib.h>

#include "opencl/cl_error.h"
#include "opencl/kernel_times.h"
#include "opencl/opencl_device.h"
#include "opencl/pinned.h"
#include "opencl/program_cache.h"
#include "opencl/programs.h"
#include "opencl/shared_device.h"

static gscl_result create_queue(gscl_context *context, gscl_opencl_device *device) {
    cl_int error;
    const cl_command_queue_properties queue_properties = device->times ? CL_QUEUE_PROFILING_ENABLE : 0;
    device->queue = gscl_cl.clCreateCommandQueue(device->context, device->id, queue_properties, &error);
    if (error != CL_SUCCESS)
        return gscl_cl_fail(context, error, "clCreateCommandQueue", "");
    return GSCL_OK;
}

gscl_result gscl_opencl_open(gscl_context *context, const gscl_listed_device *listed,
                             const gscl_context_settings *settings) {
    gscl_opencl_device *device = context->device = calloc(1, sizeof *device);
    if (!device)
        return gscl_fail_memory(context);
    device->owner = context;
    device->platform = listed->platform;
    device->id = listed->handle;
    device->quirks = listed->quirks;
    device->own_builtins = listed->quirks->own_builtins;
    device->has_pinned_reads = listed->kind != GSCL_DEVICE_CPU && !listed->shares_memory;
    GSCL_TRY(gscl_program_cache_open(context, settings->cache_folder));
    if (context->timings)
        GSCL_TRY(gscl_opencl_times_create(context)); /* before the queue, which then measures */
    GSCL_TRY(gscl_shared_device_join(context));
    return create_queue(context, device);
}

void gscl_opencl_close(gscl_context *context) {
    gscl_opencl_device *device = gscl_opencl(context);
    if (!device)
        return;
    gscl_programs_free(context);
    gscl_opencl_times_free(context);
    gscl_pinned_free(device);
    if (device->queue)
        gscl_cl.clReleaseCommandQueue(device->queue);
    gscl_shared_device_leave(context);
    gscl_program_cache_close(context);
    free(device);
    context->device = NULL;
}

bool gscl_opencl_has_double(gscl_context *context) {
    cl_device_fp_config config = 0;
    gscl_cl.clGetDeviceInfo(gscl_opencl(context)->id, CL_DEVICE_DOUBLE_FP_CONFIG, sizeof config, &config, NULL);
    return config != 0;
}
