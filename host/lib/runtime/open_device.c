#include "runtime/open_device.h"

#include "runtime/device.h"
#include "runtime/mapping.h"
#include "runtime/opencl.h"
#include "runtime/program_cache.h"
#include "runtime/programs.h"
#include "runtime/timing.h"

const char *const gscl_default_device = NULL;

/* Logs a notice of the OpenCL implementation, which may call this function at any time and from any thread. */
static void CL_CALLBACK log_notice(const char *text, const void *details, size_t size, void *context) {
    (void)details;
    (void)size;
    gscl_log(context, GSCL_LOG_WARNING, "OpenCL: %s", text ? text : "");
}

static gscl_result create_queue(gscl_context *context) {
    cl_int error;
    const cl_context_properties properties[] = {CL_CONTEXT_PLATFORM, (cl_context_properties)context->platform, 0};
    context->cl = clCreateContext(properties, 1, &context->device, log_notice, context, &error);
    if (error != CL_SUCCESS)
        return gscl_cl_fail(context, error, "clCreateContext");
    const cl_command_queue_properties queue_properties = context->timings ? CL_QUEUE_PROFILING_ENABLE : 0;
    context->queue = clCreateCommandQueue(context->cl, context->device, queue_properties, &error);
    if (error != CL_SUCCESS)
        return gscl_cl_fail(context, error, "clCreateCommandQueue");
    return GSCL_OK;
}

gscl_result gscl_device_open(gscl_context *context, const gscl_context_settings *settings) {
    GSCL_TRY(gscl_device_choose(context, settings->device));
    context->gpu_mapping =
        settings->mapping == GSCL_MAPPING_AUTO ? gscl_mapping_auto(context) : settings->mapping == GSCL_MAPPING_GPU;
    context->settle = gscl_timing_settle;
    GSCL_TRY(gscl_program_cache_open(context, settings->cache_folder));
    if (settings->timing)
        GSCL_TRY(gscl_timing_create(context)); /* before the queue, which then measures */
    return create_queue(context);
}

void gscl_device_close(gscl_context *context) {
    gscl_timing_free(context);
    gscl_programs_free(context);
    gscl_release_parked(context);
    if (context->queue)
        clReleaseCommandQueue(context->queue);
    if (context->cl)
        clReleaseContext(context->cl);
    gscl_program_cache_close(context);
}
