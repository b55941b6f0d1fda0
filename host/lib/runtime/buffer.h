/* Buffers: memory of the device, and copies to and from it. */
#ifndef GSCL_LIB_BUFFER_H
#define GSCL_LIB_BUFFER_H

#include "runtime/context.h"

struct gscl_backend; /* backend.h */

/* A device buffer that grows.  Zeroed: without memory. */
typedef struct gscl_buffer {
    void *memory;
    size_t size;                        /* bytes */
    const struct gscl_backend *backend; /* which releases the memory */
} gscl_buffer;

/* Makes the buffer hold at least `size` bytes; the content is lost when it grows.  Fails with
 * GSCL_ERROR_DEVICE_MEMORY beyond the device's largest allocation. */
gscl_result gscl_buffer_reserve(gscl_context *context, gscl_buffer *buffer, size_t size);
/* Likewise, keeping the first `keep` bytes. */
gscl_result gscl_buffer_grow(gscl_context *context, gscl_buffer *buffer, size_t size, size_t keep);
void gscl_buffer_free(gscl_buffer *buffer);
/* Room for an image of `size` bytes and a pixel vector behind it: kernels load whole vectors and mask what lies outside
 * with zeros, so that everything they may load must be finite and not 0.  A new buffer is filled with ones. */
gscl_result gscl_buffer_reserve_image(gscl_context *context, gscl_buffer *buffer, size_t size);
/* Blocking copies. */
gscl_result gscl_buffer_write(gscl_context *context, const gscl_buffer *buffer, size_t offset, const void *data,
                              size_t size);
gscl_result gscl_buffer_read(gscl_context *context, const gscl_buffer *buffer, size_t offset, void *data, size_t size);
/* Copies without waiting: the data must stay valid until a later blocking copy, or gscl_finish, has returned. */
gscl_result gscl_buffer_write_async(gscl_context *context, const gscl_buffer *buffer, size_t offset, const void *data,
                                    size_t size);
gscl_result gscl_buffer_read_async(gscl_context *context, const gscl_buffer *buffer, void *data, size_t size);
/* Makes room for the data and copies them likewise. */
gscl_result gscl_buffer_upload_async(gscl_context *context, gscl_buffer *buffer, const void *data, size_t size);
/* Blocking copy of `rows` rows of `row` bytes, which come to lie `stride` bytes apart. */
gscl_result gscl_buffer_read_rows(gscl_context *context, const gscl_buffer *buffer, size_t row, size_t rows, void *data,
                                  size_t stride);
/* Copies bytes to the same place in another buffer. */
gscl_result gscl_buffer_copy(gscl_context *context, const gscl_buffer *from, const gscl_buffer *to, size_t offset,
                             size_t size);
/* Fill bytes, whose number and offset are multiples of four: with zeros, and with floats that are 1. */
gscl_result gscl_buffer_zero(gscl_context *context, const gscl_buffer *buffer, size_t offset, size_t size);
gscl_result gscl_buffer_fill_ones(gscl_context *context, const gscl_buffer *buffer, size_t size);

#endif
