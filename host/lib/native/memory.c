#include "native/memory.h"

#include <string.h>

#include "host/system/aligned_memory.h"

#define ALIGNMENT 64 /* bytes: of the longest vector, and of a cache line */

gscl_result gscl_native_memory_create(gscl_context *context, size_t size, void **memory) {
    *memory = gscl_aligned_allocate(ALIGNMENT, size);
    return *memory ? GSCL_OK : gscl_fail_memory(context);
}

void gscl_native_memory_release(void *memory) {
    gscl_aligned_free(memory);
}

gscl_result gscl_native_write(gscl_context *context, void *memory, bool blocking, size_t offset, const void *data,
                              size_t size) {
    (void)context, (void)blocking;
    memcpy((char *)memory + offset, data, size);
    return GSCL_OK;
}

gscl_result gscl_native_read(gscl_context *context, void *memory, bool blocking, size_t offset, void *data,
                             size_t size) {
    (void)context, (void)blocking;
    memcpy(data, (const char *)memory + offset, size);
    return GSCL_OK;
}

gscl_result gscl_native_read_rows(gscl_context *context, void *memory, size_t row, size_t rows, void *data,
                                  size_t stride) {
    (void)context;
    for (size_t y = 0; y < rows; y++)
        memcpy((char *)data + y * stride, (const char *)memory + y * row, row);
    return GSCL_OK;
}

gscl_result gscl_native_copy(gscl_context *context, void *from, size_t from_offset, void *to, size_t to_offset,
                             size_t size) {
    (void)context;
    memcpy((char *)to + to_offset, (const char *)from + from_offset, size);
    return GSCL_OK;
}

gscl_result gscl_native_fill(gscl_context *context, void *memory, uint32_t pattern, size_t offset, size_t size) {
    (void)context;
    uint32_t *words = (uint32_t *)((char *)memory + offset);
    for (size_t i = 0; i < size / sizeof *words; i++)
        words[i] = pattern;
    return GSCL_OK;
}
