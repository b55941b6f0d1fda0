#include "context.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "device.h"
#include "kernels.h"
#include "opencl.h"
#include "timing.h"

gscl_result gscl_fail(gscl_context *context, gscl_result result, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(context->message, sizeof context->message, format, arguments);
    va_end(arguments);
    return result;
}

void gscl_log(const gscl_context *context, gscl_log_level level, const char *format, ...) {
    if (!context->log)
        return;
    char text[4096];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    context->log(context->log_opaque, level, text);
}

void gscl_context_settings_default(gscl_context_settings *settings) {
    if (settings)
        *settings = (gscl_context_settings){0};
}

static gscl_result open_device(gscl_context *context) {
    cl_int error;
    const cl_context_properties properties[] = {CL_CONTEXT_PLATFORM, (cl_context_properties)context->platform, 0};
    context->cl = clCreateContext(properties, 1, &context->device, NULL, NULL, &error);
    if (error != CL_SUCCESS)
        return gscl_cl_fail(context, error, "clCreateContext");
    cl_command_queue_properties measured = context->timings ? CL_QUEUE_PROFILING_ENABLE : 0;
    context->queue = clCreateCommandQueue(context->cl, context->device, measured, &error);
    if (error != CL_SUCCESS)
        return gscl_cl_fail(context, error, "clCreateCommandQueue");
    return GSCL_OK;
}

gscl_result gscl_context_create(gscl_context **context, const gscl_context_settings *settings) {
    if (!context)
        return GSCL_ERROR_INVALID_ARGUMENT;
    gscl_context_settings defaults;
    gscl_context_settings_default(&defaults);
    if (!settings)
        settings = &defaults;
    gscl_context *c = *context = calloc(1, sizeof *c);
    if (!c)
        return GSCL_ERROR_OUT_OF_MEMORY;
    c->log = settings->log;
    c->log_opaque = settings->log_opaque;
    if ((int)settings->mapping < GSCL_MAPPING_AUTO || settings->mapping > GSCL_MAPPING_GPU)
        return gscl_fail(c, GSCL_ERROR_INVALID_ARGUMENT, "mapping %d is none of auto, cpu and gpu",
                         (int)settings->mapping);
    GSCL_TRY(gscl_device_choose(c, settings->device));
    cl_device_type type = CL_DEVICE_TYPE_CPU;
    GSCL_CL(c, clGetDeviceInfo(c->device, CL_DEVICE_TYPE, sizeof type, &type, NULL));
    c->gpu_mapping =
        settings->mapping == GSCL_MAPPING_AUTO ? !(type & CL_DEVICE_TYPE_CPU) : settings->mapping == GSCL_MAPPING_GPU;
    gscl_log(c, GSCL_LOG_INFO, "device %s: %s (%s mapping)", c->info.id, c->info.device_name,
             c->gpu_mapping ? "GPU" : "CPU");
    if (settings->timing)
        GSCL_TRY(gscl_timing_create(c));
    return open_device(c);
}

void gscl_context_free(gscl_context **context) {
    if (!context || !*context)
        return;
    gscl_context *c = *context;
    gscl_decoder_free(c);
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

void gscl_context_device(const gscl_context *context, gscl_device_info *device) {
    if (context && device)
        *device = context->info;
}

const char *gscl_version(void) {
    return GSCL_VERSION;
}

void gscl_free(void *memory) {
    free(memory);
}

const char *gscl_result_text(gscl_result result) {
    switch (result) {
    case GSCL_OK:
        return "no error";
    case GSCL_ERROR_INVALID_ARGUMENT:
        return "invalid argument";
    case GSCL_ERROR_OUT_OF_MEMORY:
        return "out of memory";
    case GSCL_ERROR_CANCELLED:
        return "cancelled";
    case GSCL_ERROR_NO_PLATFORM:
        return "no OpenCL device was found; install an OpenCL implementation such as PoCL";
    case GSCL_ERROR_UNKNOWN_DEVICE:
        return "no such OpenCL device";
    case GSCL_ERROR_AMBIGUOUS_DEVICE:
        return "more than one OpenCL device matches";
    case GSCL_ERROR_DEVICE_MEMORY:
        return "the OpenCL device has too little memory";
    case GSCL_ERROR_DEVICE_FAILED:
        return "an OpenCL call failed";
    case GSCL_ERROR_KERNEL_BUILD:
        return "the OpenCL device could not build the kernels";
    case GSCL_ERROR_NOT_GSCL:
        return "not a gscl file";
    case GSCL_ERROR_NEWER_VERSION:
        return "written in a newer format version than this program reads";
    case GSCL_ERROR_TRUNCATED:
        return "the file is incomplete";
    case GSCL_ERROR_DAMAGED:
        return "the file is damaged: its checksum does not match";
    case GSCL_ERROR_CORRUPT:
        return "the file holds values outside the format's limits";
    case GSCL_ERROR_IMAGE_SIZE:
        return "image size outside 1x1 to 16384x16384";
    case GSCL_ERROR_IMAGE_NOT_FINITE:
        return "the image has NaN or infinite samples";
    case GSCL_ERROR_BUDGET_TOO_SMALL:
        return "no file can be that small";
    case GSCL_ERROR_TARGET_UNREACHABLE:
        return "the quality asked for cannot be reached";
    case GSCL_ERROR_CONFLICT:
        return "settings that exclude each other";
    }
    return "unknown error";
}
