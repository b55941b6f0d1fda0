/* Memory of the processor: these functions of gscl_backend. */
#ifndef GSCL_LIB_NATIVE_MEMORY_H
#define GSCL_LIB_NATIVE_MEMORY_H

#include "runtime/context.h"

gscl_result gscl_native_memory_create(gscl_context *context, size_t size, void **memory);
void gscl_native_memory_release(void *memory);
gscl_result gscl_native_write(gscl_context *context, void *memory, bool blocking, size_t offset, const void *data,
                              size_t size);
gscl_result gscl_native_read(gscl_context *context, void *memory, bool blocking, size_t offset, void *data,
                             size_t size);
gscl_result gscl_native_read_rows(gscl_context *context, void *memory, size_t row, size_t rows, void *data,
                                  size_t stride);
gscl_result gscl_native_copy(gscl_context *context, void *from, size_t from_offset, void *to, size_t to_offset,
                             size_t size);
gscl_result gscl_native_fill(gscl_context *context, void *memory, uint32_t pattern, size_t offset, size_t size);

#endif
