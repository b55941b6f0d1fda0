#include "runtime/buffer.h"

#include <inttypes.h>

#include "runtime/backend.h"
#include "runtime/queue.h"

#define MAX_PIXEL_VECTOR 64 /* bytes: 16 floats */
#define ONE 0x3F800000      /* the bits of the float 1 */

static gscl_result buffer_create(gscl_context *context, size_t size, gscl_buffer *buffer) {
    /* Some implementations report a failed allocation late or not at all: check what can be known. */
    if (size > context->info.max_allocation_bytes)
        return gscl_fail(context, GSCL_ERROR_DEVICE_MEMORY,
                         "%s allows buffers of at most %" PRIu64 " MiB, this image needs one of %zu MiB",
                         context->info.device_name, context->info.max_allocation_bytes >> 20, size >> 20);
    *buffer = (gscl_buffer){.size = size, .backend = context->backend};
    return context->backend->memory_create(context, size, &buffer->memory);
}

static gscl_result buffer_copy(gscl_context *context, const gscl_buffer *from, const gscl_buffer *to, size_t offset,
                               size_t size) {
    return gscl_note_work(context, false,
                          context->backend->copy(context, from->memory, offset, to->memory, offset, size));
}

static gscl_result buffer_fill(gscl_context *context, const gscl_buffer *buffer, uint32_t pattern, size_t offset,
                               size_t size) {
    if (size == 0)
        return GSCL_OK;
    return gscl_note_work(context, false, context->backend->fill(context, buffer->memory, pattern, offset, size));
}

gscl_result gscl_buffer_reserve(gscl_context *context, gscl_buffer *buffer, size_t size) {
    return gscl_buffer_grow(context, buffer, size, 0);
}

gscl_result gscl_buffer_reserve_image(gscl_context *context, gscl_buffer *buffer, size_t size) {
    size += MAX_PIXEL_VECTOR;
    if (buffer->memory && size <= buffer->size)
        return GSCL_OK;
    GSCL_TRY(gscl_buffer_reserve(context, buffer, size));
    const gscl_result result = gscl_buffer_fill_ones(context, buffer, size);
    if (result != GSCL_OK)
        gscl_buffer_free(buffer); /* the next call must not take it for a buffer that was filled */
    return result;
}

gscl_result gscl_buffer_grow(gscl_context *context, gscl_buffer *buffer, size_t size, size_t keep) {
    if (size == 0)
        size = 64; /* no implementation needs empty buffers, and OpenCL has none */
    if (buffer->memory && size <= buffer->size)
        return GSCL_OK;
    if (keep > buffer->size)
        keep = buffer->size;
    if (buffer->memory && keep == 0)
        gscl_buffer_free(buffer); /* before the new one: halves the peak */
    gscl_buffer grown;
    GSCL_TRY(buffer_create(context, size, &grown));
    const gscl_result result = keep > 0 ? buffer_copy(context, buffer, &grown, 0, keep) : GSCL_OK;
    gscl_buffer_free(result == GSCL_OK ? buffer : &grown);
    if (result == GSCL_OK)
        *buffer = grown;
    return result;
}

void gscl_buffer_free(gscl_buffer *buffer) {
    if (buffer->memory)
        buffer->backend->memory_release(buffer->memory);
    *buffer = (gscl_buffer){0};
}

static gscl_result buffer_write(gscl_context *context, const gscl_buffer *buffer, bool blocking, size_t offset,
                                const void *data, size_t size) {
    if (size == 0)
        return GSCL_OK;
    return gscl_note_work(context, blocking,
                          context->backend->write(context, buffer->memory, blocking, offset, data, size));
}

static gscl_result buffer_read(gscl_context *context, const gscl_buffer *buffer, bool blocking, size_t offset,
                               void *data, size_t size) {
    if (size == 0)
        return GSCL_OK;
    return gscl_note_work(context, blocking,
                          context->backend->read(context, buffer->memory, blocking, offset, data, size));
}

gscl_result gscl_buffer_write(gscl_context *context, const gscl_buffer *buffer, size_t offset, const void *data,
                              size_t size) {
    return buffer_write(context, buffer, true, offset, data, size);
}

gscl_result gscl_buffer_write_async(gscl_context *context, const gscl_buffer *buffer, size_t offset, const void *data,
                                    size_t size) {
    return buffer_write(context, buffer, false, offset, data, size);
}

gscl_result gscl_buffer_read(gscl_context *context, const gscl_buffer *buffer, size_t offset, void *data, size_t size) {
    return buffer_read(context, buffer, true, offset, data, size);
}

gscl_result gscl_buffer_read_async(gscl_context *context, const gscl_buffer *buffer, void *data, size_t size) {
    return buffer_read(context, buffer, false, 0, data, size);
}

gscl_result gscl_buffer_upload_async(gscl_context *context, gscl_buffer *buffer, const void *data, size_t size) {
    GSCL_TRY(gscl_buffer_reserve(context, buffer, size));
    return gscl_buffer_write_async(context, buffer, 0, data, size);
}

gscl_result gscl_buffer_read_rows(gscl_context *context, const gscl_buffer *buffer, size_t row, size_t rows, void *data,
                                  size_t stride) {
    return gscl_note_work(context, true, context->backend->read_rows(context, buffer->memory, row, rows, data, stride));
}

gscl_result gscl_buffer_copy(gscl_context *context, const gscl_buffer *from, const gscl_buffer *to, size_t offset,
                             size_t size) {
    return buffer_copy(context, from, to, offset, size);
}

gscl_result gscl_buffer_zero(gscl_context *context, const gscl_buffer *buffer, size_t offset, size_t size) {
    return buffer_fill(context, buffer, 0, offset, size);
}

gscl_result gscl_buffer_fill_ones(gscl_context *context, const gscl_buffer *buffer, size_t size) {
    return buffer_fill(context, buffer, ONE, 0, size);
}
