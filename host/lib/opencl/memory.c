#include "opencl/memory.h"

#include "opencl/cl_error.h"
#include "opencl/opencl_device.h"
#include "opencl/pinned.h"

gscl_result gscl_opencl_memory_create(gscl_context *context, size_t size, void **memory) {
    cl_int error;
    *memory = gscl_cl.clCreateBuffer(gscl_opencl(context)->context, CL_MEM_READ_WRITE, size, NULL, &error);
    return error == CL_SUCCESS ? GSCL_OK : gscl_cl_fail(context, error, "clCreateBuffer", "");
}

void gscl_opencl_memory_release(void *memory) {
    gscl_cl.clReleaseMemObject(memory);
}

gscl_result gscl_opencl_write(gscl_context *context, void *memory, bool blocking, size_t offset, const void *data,
                              size_t size) {
    GSCL_CL(context, clEnqueueWriteBuffer, gscl_opencl(context)->queue, memory, blocking, offset, size, data, 0, NULL,
            NULL);
    return GSCL_OK;
}

gscl_result gscl_opencl_read(gscl_context *context, void *memory, bool blocking, size_t offset, void *data,
                             size_t size) {
    const gscl_pinned_rows all = {.offset = offset, .row = size, .rows = 1, .data = data};
    if (blocking && gscl_pinned_serves(context, &all))
        return gscl_pinned_read(context, memory, &all);
    GSCL_CL(context, clEnqueueReadBuffer, gscl_opencl(context)->queue, memory, blocking, offset, size, data, 0, NULL,
            NULL);
    return GSCL_OK;
}

gscl_result gscl_opencl_read_rows(gscl_context *context, void *memory, size_t row, size_t rows, void *data,
                                  size_t stride) {
    const size_t origin[3] = {0}, region[3] = {row, rows, 1};
    const gscl_pinned_rows all = {.row = row, .rows = rows, .stride = stride, .data = data};
    if (gscl_pinned_serves(context, &all))
        return gscl_pinned_read(context, memory, &all);
    GSCL_CL(context, clEnqueueReadBufferRect, gscl_opencl(context)->queue, memory, CL_TRUE, origin, origin, region, row,
            0, stride, 0, data, 0, NULL, NULL);
    return GSCL_OK;
}

gscl_result gscl_opencl_copy(gscl_context *context, void *from, size_t from_offset, void *to, size_t to_offset,
                             size_t size) {
    GSCL_CL(context, clEnqueueCopyBuffer, gscl_opencl(context)->queue, from, to, from_offset, to_offset, size, 0, NULL,
            NULL);
    return GSCL_OK;
}

gscl_result gscl_opencl_fill(gscl_context *context, void *memory, uint32_t pattern, size_t offset, size_t size) {
    GSCL_CL(context, clEnqueueFillBuffer, gscl_opencl(context)->queue, memory, &pattern, sizeof pattern, offset, size,
            0, NULL, NULL);
    return GSCL_OK;
}
