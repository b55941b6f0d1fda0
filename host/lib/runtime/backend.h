/* The interface of devices: what an implementation does for a context.  The rooms above see buffer.h, launch.h and queue.h,
 * which do what all implementations share.
 *
 * A function that can fail stores the message of its failure (gscl_fail).  Work runs in the order in which it was asked for;
 * a call that does not block may return before its work has ended, or begun. */
#ifndef GSCL_LIB_BACKEND_H
#define GSCL_LIB_BACKEND_H

#include <gscl/measure.h>

#include "runtime/context.h"
#include "runtime/device_list.h"
#include "runtime/kernel_options.h"

/* A kernel of a context.  An implementation makes it the first field of a struct of its own. */
typedef struct gscl_kernel {
    const char *name; /* of its function in cl/ */
    bool may_build;   /* its first launch is yet to come, and may build it */
} gscl_kernel;

/* A value that a kernel takes, or a buffer: the address of gscl_buffer.memory. */
typedef struct gscl_argument {
    size_t size; /* bytes */
    const void *value;
} gscl_argument;

/* A kernel that is launched with arguments 0, 1, ... */
typedef struct gscl_launch {
    gscl_kernel *kernel;
    size_t groups, group_size; /* neither is 0; in one dimension */
    const gscl_argument *arguments;
    size_t argument_count;
    gscl_timing *timing; /* where to add the time that the kernel runs (gscl_timing_add); NULL: it is not measured */
} gscl_launch;

/* A program that is needed later. */
typedef struct gscl_program_request {
    gscl_program_kind kind;
    gscl_kernel_options options;
} gscl_program_request;

typedef struct gscl_backend {
    bool is_host; /* its only device is GSCL_HOST_DEVICE */
    /* Appends all devices; GSCL_ERROR_OUT_OF_MEMORY is the only failure. */
    gscl_result (*list)(gscl_device_list *list);
    /* Opens the device: context->device, for which all that gscl_device_open sets is set. */
    gscl_result (*open)(gscl_context *context, const gscl_listed_device *device, const gscl_context_settings *settings);
    /* Releases context->device with its programs, after its work has ended or failed; accepts one that was not opened, or not
     * wholly. */
    void (*close)(gscl_context *context);

    /* Memory of at least one byte, within the device's largest allocation. */
    gscl_result (*memory_create)(gscl_context *context, size_t size, void **memory);
    void (*memory_release)(void *memory);
    /* Copies between the host and the device.  Without `blocking` the host's memory stays as it is until a later call that
     * blocks. */
    gscl_result (*write)(gscl_context *context, void *memory, bool blocking, size_t offset, const void *data,
                         size_t size);
    gscl_result (*read)(gscl_context *context, void *memory, bool blocking, size_t offset, void *data, size_t size);
    /* Blocks: rows of `row` bytes, which come to lie `stride` bytes apart. */
    gscl_result (*read_rows)(gscl_context *context, void *memory, size_t row, size_t rows, void *data, size_t stride);
    /* Copies between two different memories. */
    gscl_result (*copy)(gscl_context *context, void *from, size_t from_offset, void *to, size_t to_offset, size_t size);
    /* Repeats four bytes; offset and size are multiples of four. */
    gscl_result (*fill)(gscl_context *context, void *memory, uint32_t pattern, size_t offset, size_t size);

    /* Looks a kernel up and builds its program where it must.  The context owns the kernel.  `name` outlives the context. */
    gscl_result (*kernel_find)(gscl_context *context, gscl_program_kind kind, const gscl_kernel_options *options,
                               const char *name, gscl_kernel **kernel);
    gscl_result (*launch)(gscl_context *context, const gscl_launch *launch);
    /* Begins the work that it may be collecting; NULL: it begins all work at once.  A failure shows in a later call. */
    void (*flush)(gscl_context *context);
    /* Waits until all work has ended. */
    gscl_result (*finish)(gscl_context *context);
    /* Adds the times of launches up, when all work has ended or failed. */
    void (*collect_times)(gscl_context *context);

    /* Begins to build programs, and ends that: gscl_prefetch and gscl_prefetch_end. */
    void (*prefetch)(gscl_context *context, const gscl_program_request *requests, size_t count);
    void (*prefetch_end)(gscl_context *context);

    /* Whether kernels may compute in double precision. */
    bool (*has_double)(gscl_context *context);
} gscl_backend;

#endif
