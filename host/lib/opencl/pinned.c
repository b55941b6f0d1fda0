#include "opencl/pinned.h"

#include <string.h>

#include "opencl/cl_error.h"
#include "opencl/tunables.h"

#define HALVES 2

static size_t total_size(const gscl_pinned_rows *rows) {
    return rows->row * rows->rows;
}

/* ---- The memory ---- */

static bool create(gscl_opencl_device *device) {
    const size_t size = HALVES * gscl_opencl_tunables.pinned_half;
    gscl_pinned_memory *pinned = &device->pinned;
    cl_int error;
    pinned->memory =
        gscl_cl.clCreateBuffer(device->context, CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, size, NULL, &error);
    if (error != CL_SUCCESS) {
        pinned->memory = NULL;
        return false;
    }
    pinned->bytes = gscl_cl.clEnqueueMapBuffer(device->queue, pinned->memory, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0,
                                               size, 0, NULL, NULL, &error);
    if (error == CL_SUCCESS)
        return true;
    gscl_cl.clReleaseMemObject(pinned->memory);
    *pinned = (gscl_pinned_memory){0};
    return false;
}

bool gscl_pinned_serves(gscl_context *context, const gscl_pinned_rows *rows) {
    gscl_opencl_device *device = gscl_opencl(context);
    if (!device->has_pinned_reads || total_size(rows) < gscl_opencl_tunables.pinned_least)
        return false;
    device->has_pinned_reads = device->pinned.memory || create(device);
    return device->has_pinned_reads;
}

void gscl_pinned_free(gscl_opencl_device *device) {
    gscl_pinned_memory *pinned = &device->pinned;
    if (!pinned->memory)
        return;
    gscl_cl.clEnqueueUnmapMemObject(device->queue, pinned->memory, pinned->bytes, 0, NULL, NULL);
    gscl_cl.clReleaseMemObject(pinned->memory);
    *pinned = (gscl_pinned_memory){0};
}

/* ---- Reading ---- */

/* Copies `size` bytes, of which the first is number `from` of all, to where they belong. */
static void place(const gscl_pinned_rows *rows, size_t from, const char *bytes, size_t size) {
    while (size > 0) {
        const size_t x = from % rows->row, left = rows->row - x, part = left < size ? left : size;
        memcpy((char *)rows->data + from / rows->row * rows->stride + x, bytes, part);
        from += part;
        bytes += part;
        size -= part;
    }
}

/* The part of a read that a half holds. */
typedef struct read_part {
    size_t from, size; /* bytes of all that are read */
    char *half;
    cl_event event;
} read_part;

static gscl_result begin_part(gscl_context *context, cl_mem memory, const gscl_pinned_rows *rows, size_t from,
                              read_part *part) {
    gscl_opencl_device *device = gscl_opencl(context);
    const size_t half = gscl_opencl_tunables.pinned_half, left = total_size(rows) - from;
    *part = (read_part){
        .from = from, .size = left < half ? left : half, .half = device->pinned.bytes + from / half % HALVES * half};
    GSCL_CL(context, clEnqueueReadBuffer, device->queue, memory, CL_FALSE, rows->offset + from, part->size, part->half,
            0, NULL, &part->event);
    GSCL_CL(context, clFlush, device->queue);
    return GSCL_OK;
}

static gscl_result wait_for(gscl_context *context, const read_part *part) {
    GSCL_CL(context, clWaitForEvents, 1, &part->event);
    return GSCL_OK;
}

static void release(read_part *part) {
    if (part->event)
        gscl_cl.clReleaseEvent(part->event);
    part->event = NULL;
}

gscl_result gscl_pinned_read(gscl_context *context, cl_mem memory, const gscl_pinned_rows *rows) {
    read_part part = {0}, next = {0};
    gscl_result result = begin_part(context, memory, rows, 0, &part);
    while (result == GSCL_OK && part.size > 0) {
        const size_t end = part.from + part.size;
        next = (read_part){.from = end};
        if (end < total_size(rows))
            result = begin_part(context, memory, rows, end, &next);
        if (result == GSCL_OK)
            result = wait_for(context, &part);
        if (result == GSCL_OK)
            place(rows, part.from, part.half, part.size);
        release(&part);
        part = next;
    }
    release(&part);
    return result;
}
