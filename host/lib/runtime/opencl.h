/* Thin helpers over OpenCL calls: checked calls, checked buffers, kernel arguments in one line. */
#ifndef GSCL_LIB_OPENCL_H
#define GSCL_LIB_OPENCL_H

#include <CL/cl.h>

#include "runtime/context.h"

/* Stores "CALL on DEVICE: ERROR" as the message and returns the result that fits the error. */
gscl_result gscl_cl_fail(gscl_context *context, cl_int error, const char *call);

/* Makes an OpenCL call; returns from the function when it fails. */
#define GSCL_CL(context, call)                              \
    do {                                                    \
        cl_int cl_error_ = (call);                          \
        if (cl_error_ != CL_SUCCESS)                        \
            return gscl_cl_fail(context, cl_error_, #call); \
    } while (0)

/* A device buffer that grows. */
typedef struct gscl_buffer {
    cl_mem memory;
    size_t size; /* bytes */
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
gscl_result gscl_buffer_write_async(gscl_context *context, const gscl_buffer *buffer, const void *data, size_t size);
gscl_result gscl_buffer_read_async(gscl_context *context, const gscl_buffer *buffer, void *data, size_t size);
/* Makes room for the data and copies them likewise. */
gscl_result gscl_buffer_upload_async(gscl_context *context, gscl_buffer *buffer, const void *data, size_t size);
/* Blocking copy of `rows` rows of `row` bytes, which come to lie `stride` bytes apart. */
gscl_result gscl_buffer_read_rows(gscl_context *context, const gscl_buffer *buffer, size_t row, size_t rows, void *data,
                                  size_t stride);
/* Waits until the queue is empty; accepts a context without one.  Where nothing was enqueued since the last wait, this and
 * what waits below return at once. */
gscl_result gscl_finish(gscl_context *context);
/* Releases memory of the host that copies without waiting may still use: after waiting for the device or, where that
 * fails, when a later call of these two can wait.  Leaves the context's message as it is.  `memory` may be NULL. */
void gscl_release_after_copies(gscl_context *context, void *memory);
/* Releases what is left of that, before the queue is released. */
void gscl_release_parked(gscl_context *context);
/* Copies bytes to the same place in another buffer. */
gscl_result gscl_buffer_copy(gscl_context *context, const gscl_buffer *from, const gscl_buffer *to, size_t offset,
                             size_t size);
gscl_result gscl_buffer_zero(gscl_context *context, const gscl_buffer *buffer, size_t offset, size_t size);

/* Sets arguments 0, 1, ... of a kernel from (size, pointer) pairs and enqueues `groups` work-groups of
 * `group_size` work-items in one dimension.  Messages name the kernel.  Debug builds check the number of arguments. */
typedef struct gscl_argument {
    size_t size; /* bytes */
    const void *value;
} gscl_argument;
#define GSCL_ARG(x) ((gscl_argument){sizeof(x), &(x)})
#define GSCL_ARG_BUFFER(b) ((gscl_argument){sizeof(cl_mem), &(b).memory})
gscl_result gscl_launch_(gscl_context *context, cl_kernel kernel, size_t groups, size_t group_size,
                         const gscl_argument *arguments, size_t count);
#define GSCL_LAUNCH(context, kernel, groups, group_size, ...)                               \
    gscl_launch_(context, kernel, groups, group_size, (const gscl_argument[]){__VA_ARGS__}, \
                 sizeof((const gscl_argument[]){__VA_ARGS__}) / sizeof(gscl_argument))

#endif
