/* Public functions that create, free and query a context. */
#include <stdlib.h>

#include "runtime/context.h"
#include "runtime/device.h"
#include "runtime/opencl.h"
#include "runtime/programs.h"
#include "runtime/struct_size.h"
#include "runtime/timing.h"

void gscl_context_settings_init(gscl_context_settings *settings, size_t struct_size) {
    const gscl_context_settings defaults = {0};
    gscl_struct_init(settings, struct_size, &defaults, sizeof defaults);
}

/* Logs a notice of the OpenCL implementation, which may call this function at any time and from any thread. */
static void CL_CALLBACK log_notice(const char *text, const void *details, size_t size, void *context) {
    (void)details;
    (void)size;
    gscl_log(context, GSCL_LOG_WARNING, "OpenCL: %s", text ? text : "");
}

static gscl_result context_open(gscl_context *context) {
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

gscl_result gscl_context_create(gscl_context **context, const gscl_context_settings *settings) {
    if (!context)
        return GSCL_ERROR_INVALID_ARGUMENT;
    gscl_context *c = *context = calloc(1, sizeof *c);
    if (!c)
        return GSCL_ERROR_OUT_OF_MEMORY;
    gscl_context_settings s;
    gscl_context_settings_default(&s);
    GSCL_TRY(GSCL_STRUCT_READ(c, gscl_context_settings, log, settings, &s));
    c->log = s.log;
    c->log_opaque = s.log_opaque;
    if ((int)s.mapping < GSCL_MAPPING_AUTO || s.mapping > GSCL_MAPPING_GPU)
        return gscl_fail(c, GSCL_ERROR_INVALID_ARGUMENT, "mapping %d is none of auto, cpu and gpu", (int)s.mapping);
    GSCL_TRY(gscl_device_choose(c, s.device));
    c->gpu_mapping = s.mapping == GSCL_MAPPING_AUTO ? !c->is_cpu : s.mapping == GSCL_MAPPING_GPU;
    gscl_log(c, GSCL_LOG_INFO, "device %s: %s (%s mapping)", c->info.id, c->info.device_name,
             c->gpu_mapping ? "GPU" : "CPU");
    if (s.timing)
        GSCL_TRY(gscl_timing_create(c));
    return context_open(c);
}

void gscl_context_free(gscl_context **context) {
    if (!context || !*context)
        return;
    gscl_context *c = *context;
    if (c->decoder)
        c->decoder_free(c->decoder);
    gscl_timing_free(c);
    gscl_programs_free(c);
    if (c->queue)
        clReleaseCommandQueue(c->queue);
    if (c->cl)
        clReleaseContext(c->cl);
    free(c);
    *context = NULL;
}

const char *gscl_context_message(const gscl_context *context) {
    return context ? context->message : "";
}

const gscl_device_info *gscl_context_device(const gscl_context *context) {
    return context ? &context->info : NULL;
}
