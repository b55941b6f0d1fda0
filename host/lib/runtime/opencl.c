#include "runtime/opencl.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "runtime/cl_names.h"
#include "runtime/queue.h"
#include "runtime/timing.h"

#define MAX_PIXEL_VECTOR 64 /* bytes: 16 floats */

/* `subject`: the object of the call, such as " of kernel bin", or "". */
static gscl_result cl_fail(gscl_context *context, cl_int error, const char *call, const char *subject) {
    gscl_result result = GSCL_ERROR_DEVICE_FAILED;
    if (error == CL_MEM_OBJECT_ALLOCATION_FAILURE || error == CL_INVALID_BUFFER_SIZE)
        result = GSCL_ERROR_DEVICE_MEMORY;
    if (error == CL_OUT_OF_HOST_MEMORY)
        result = GSCL_ERROR_OUT_OF_MEMORY;
    const int length = (int)strcspn(call, "("); /* the function's name is enough */
    return gscl_fail(context, result, "%.*s%s on %s: %s%s (%d)", length, call, subject, context->info.device_name,
                     error == CL_OUT_OF_RESOURCES ? "the device ran out of resources, " : "", gscl_cl_error_name(error),
                     (int)error);
}

gscl_result gscl_cl_fail(gscl_context *context, cl_int error, const char *call) {
    return cl_fail(context, error, call, "");
}

static gscl_result buffer_create(gscl_context *context, size_t size, cl_mem *memory) {
    /* Some implementations report a failed allocation late or not at all: check what can be known. */
    if (size > context->info.max_allocation_bytes)
        return gscl_fail(context, GSCL_ERROR_DEVICE_MEMORY,
                         "%s allows buffers of at most %" PRIu64 " MiB, this image needs one of %zu MiB",
                         context->info.device_name, context->info.max_allocation_bytes >> 20, size >> 20);
    cl_int error;
    *memory = clCreateBuffer(context->cl, CL_MEM_READ_WRITE, size, NULL, &error);
    if (error != CL_SUCCESS)
        return gscl_cl_fail(context, error, "clCreateBuffer");
    return GSCL_OK;
}

gscl_result gscl_buffer_reserve(gscl_context *context, gscl_buffer *buffer, size_t size) {
    return gscl_buffer_grow(context, buffer, size, 0);
}

gscl_result gscl_buffer_reserve_image(gscl_context *context, gscl_buffer *buffer, size_t size) {
    const cl_float one = 1.0f;
    size += MAX_PIXEL_VECTOR;
    if (buffer->memory && size <= buffer->size)
        return GSCL_OK;
    GSCL_TRY(gscl_buffer_reserve(context, buffer, size));
    const cl_int error = gscl_queue_note_work(
        context, CL_FALSE,
        clEnqueueFillBuffer(context->queue, buffer->memory, &one, sizeof one, 0, size, 0, NULL, NULL));
    if (error == CL_SUCCESS)
        return GSCL_OK;
    gscl_buffer_free(buffer); /* the next call must not take it for a buffer that was filled */
    return gscl_cl_fail(context, error, "clEnqueueFillBuffer");
}

gscl_result gscl_buffer_grow(gscl_context *context, gscl_buffer *buffer, size_t size, size_t keep) {
    if (size == 0)
        size = 64; /* OpenCL has no empty buffers */
    if (buffer->memory && size <= buffer->size)
        return GSCL_OK;
    if (keep > buffer->size)
        keep = buffer->size;
    cl_mem memory = NULL;
    if (buffer->memory && keep == 0)
        gscl_buffer_free(buffer); /* before the new one: halves the peak */
    GSCL_TRY(buffer_create(context, size, &memory));
    if (keep > 0) {
        const cl_int error = gscl_queue_note_work(
            context, CL_FALSE, clEnqueueCopyBuffer(context->queue, buffer->memory, memory, 0, 0, keep, 0, NULL, NULL));
        if (error != CL_SUCCESS) {
            clReleaseMemObject(memory);
            return gscl_cl_fail(context, error, "clEnqueueCopyBuffer");
        }
    }
    gscl_buffer_free(buffer);
    *buffer = (gscl_buffer){memory, size};
    return GSCL_OK;
}

void gscl_buffer_free(gscl_buffer *buffer) {
    if (buffer->memory)
        clReleaseMemObject(buffer->memory);
    *buffer = (gscl_buffer){NULL, 0};
}

static gscl_result buffer_write(gscl_context *context, const gscl_buffer *buffer, cl_bool blocking, size_t offset,
                                const void *data, size_t size) {
    if (size > 0)
        GSCL_CL(context, gscl_queue_note_work(context, blocking,
                                              clEnqueueWriteBuffer(context->queue, buffer->memory, blocking, offset,
                                                                   size, data, 0, NULL, NULL)));
    return GSCL_OK;
}

static gscl_result buffer_read(gscl_context *context, const gscl_buffer *buffer, cl_bool blocking, size_t offset,
                               void *data, size_t size) {
    if (size > 0)
        GSCL_CL(context, gscl_queue_note_work(context, blocking,
                                              clEnqueueReadBuffer(context->queue, buffer->memory, blocking, offset,
                                                                  size, data, 0, NULL, NULL)));
    return GSCL_OK;
}

gscl_result gscl_buffer_write(gscl_context *context, const gscl_buffer *buffer, size_t offset, const void *data,
                              size_t size) {
    return buffer_write(context, buffer, CL_TRUE, offset, data, size);
}

gscl_result gscl_buffer_write_async(gscl_context *context, const gscl_buffer *buffer, const void *data, size_t size) {
    return buffer_write(context, buffer, CL_FALSE, 0, data, size);
}

gscl_result gscl_buffer_read(gscl_context *context, const gscl_buffer *buffer, size_t offset, void *data, size_t size) {
    return buffer_read(context, buffer, CL_TRUE, offset, data, size);
}

gscl_result gscl_buffer_read_async(gscl_context *context, const gscl_buffer *buffer, void *data, size_t size) {
    return buffer_read(context, buffer, CL_FALSE, 0, data, size);
}

gscl_result gscl_buffer_read_rows(gscl_context *context, const gscl_buffer *buffer, size_t row, size_t rows, void *data,
                                  size_t stride) {
    const size_t origin[3] = {0}, region[3] = {row, rows, 1};
    GSCL_CL(context,
            gscl_queue_note_work(context, CL_TRUE,
                                 clEnqueueReadBufferRect(context->queue, buffer->memory, CL_TRUE, origin, origin,
                                                         region, row, 0, stride, 0, data, 0, NULL, NULL)));
    return GSCL_OK;
}

gscl_result gscl_finish(gscl_context *context) {
    GSCL_CL(context, gscl_queue_finish(context));
    return GSCL_OK;
}

struct gscl_parked {
    struct gscl_parked *next;
    void *memory;
};

/* Releases all parked memory if the device has ended its work. */
static bool release_if_finished(gscl_context *context) {
    if (gscl_queue_finish(context) != CL_SUCCESS)
        return false;
    while (context->parked) {
        struct gscl_parked *first = context->parked;
        context->parked = first->next;
        free(first->memory);
        free(first);
    }
    return true;
}

void gscl_release_after_copies(gscl_context *context, void *memory) {
    if (!memory)
        return;
    if (release_if_finished(context)) {
        free(memory);
        return;
    }
    struct gscl_parked *parked = malloc(sizeof *parked);
    if (!parked)
        return; /* the memory is lost, which is better than a device that writes into it after its release */
    *parked = (struct gscl_parked){context->parked, memory};
    context->parked = parked;
}

void gscl_release_parked(gscl_context *context) {
    if (release_if_finished(context))
        return;
    while (context->parked) { /* as above, the memory itself is lost */
        struct gscl_parked *next = context->parked->next;
        free(context->parked);
        context->parked = next;
    }
}

gscl_result gscl_buffer_upload_async(gscl_context *context, gscl_buffer *buffer, const void *data, size_t size) {
    GSCL_TRY(gscl_buffer_reserve(context, buffer, size));
    return gscl_buffer_write_async(context, buffer, data, size);
}

gscl_result gscl_buffer_copy(gscl_context *context, const gscl_buffer *from, const gscl_buffer *to, size_t offset,
                             size_t size) {
    GSCL_CL(context, gscl_queue_note_work(context, CL_FALSE,
                                          clEnqueueCopyBuffer(context->queue, from->memory, to->memory, offset, offset,
                                                              size, 0, NULL, NULL)));
    return GSCL_OK;
}

gscl_result gscl_buffer_zero(gscl_context *context, const gscl_buffer *buffer, size_t offset, size_t size) {
    if (size == 0)
        return GSCL_OK;
    const cl_uint zero = 0;
    GSCL_CL(context, gscl_queue_note_work(context, CL_FALSE,
                                          clEnqueueFillBuffer(context->queue, buffer->memory, &zero, sizeof zero,
                                                              offset, size, 0, NULL, NULL)));
    return GSCL_OK;
}

static gscl_result launch_fail(gscl_context *context, cl_kernel kernel, cl_int error, const char *call) {
    char name[GSCL_MAX_KERNEL_NAME], subject[GSCL_MAX_KERNEL_NAME + 16];
    gscl_kernel_name(kernel, name);
    snprintf(subject, sizeof subject, " of kernel %s", name);
    return cl_fail(context, error, call, subject);
}

#ifndef NDEBUG
/* OpenCL itself does not notice a missing argument that an earlier launch has set. */
static gscl_result launch_check_count(gscl_context *context, cl_kernel kernel, size_t count) {
    cl_uint expected = 0;
    char name[GSCL_MAX_KERNEL_NAME];
    const cl_int error = clGetKernelInfo(kernel, CL_KERNEL_NUM_ARGS, sizeof expected, &expected, NULL);
    if (error != CL_SUCCESS)
        return launch_fail(context, kernel, error, "clGetKernelInfo");
    gscl_kernel_name(kernel, name);
    return count == expected
               ? GSCL_OK
               : gscl_fail(context, GSCL_ERROR_DEVICE_FAILED, "kernel %s takes %u arguments, it was launched with %zu",
                           name, (unsigned)expected, count);
}
#endif

/* Whether this is the first launch of a kernel that some implementations build only now; counts as a launch. */
static bool launch_may_build(gscl_context *context, cl_kernel kernel) {
    for (size_t i = 0; i < context->unlaunched_count; i++)
        if (context->unlaunched[i] == kernel) {
            context->unlaunched[i] = context->unlaunched[--context->unlaunched_count];
            return true;
        }
    return false;
}

/* Waits for a launch that may build its kernel. */
static cl_int launch_wait(gscl_context *context, cl_kernel kernel, double start_s, cl_int error) {
    if (error == CL_SUCCESS)
        error = gscl_queue_finish(context);
    gscl_timing_add_build(context, kernel, gscl_now() - start_s);
    gscl_report_build(context, false);
    return error;
}

gscl_result gscl_launch_(gscl_context *context, cl_kernel kernel, size_t groups, size_t group_size,
                         const gscl_argument *arguments, size_t count) {
    const size_t global_size = groups * group_size;
    cl_int error = CL_SUCCESS;
#ifndef NDEBUG
    GSCL_TRY(launch_check_count(context, kernel, count));
#endif
    for (size_t i = 0; i < count && error == CL_SUCCESS; i++)
        error = clSetKernelArg(kernel, (cl_uint)i, arguments[i].size, arguments[i].value);
    if (error != CL_SUCCESS)
        return launch_fail(context, kernel, error, "clSetKernelArg");
    if (groups == 0)
        return GSCL_OK;
    const bool may_build = (context->build || context->timings) && launch_may_build(context, kernel);
    const double start_s = may_build ? gscl_now() : 0;
    if (may_build)
        gscl_report_build(context, true);
    cl_event *event = gscl_timing_event(context, kernel, global_size); /* may wait */
    error = gscl_queue_note_work(
        context, CL_FALSE,
        clEnqueueNDRangeKernel(context->queue, kernel, 1, NULL, &global_size, &group_size, 0, NULL, event));
    if (may_build)
        error = launch_wait(context, kernel, start_s, error);
    return error == CL_SUCCESS ? GSCL_OK : launch_fail(context, kernel, error, "clEnqueueNDRangeKernel");
}
