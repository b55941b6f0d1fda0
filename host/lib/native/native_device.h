/* The processor as the device of a context: threads, and the kernels that were looked up. */
#ifndef GSCL_LIB_NATIVE_DEVICE_H
#define GSCL_LIB_NATIVE_DEVICE_H

#include "native/pool.h"
#include "native/programs.h"
#include "runtime/backend.h"

typedef struct gscl_kept_kernel {
    gscl_kernel base;
    struct gscl_kept_kernel *next;
    const gscl_native_kernel *compiled;
    gscl_native_options options;
    double item_s; /* time that a work-item took in recent launches, seconds; 0 before the first */
} gscl_kept_kernel;

typedef struct gscl_native_device {
    const gscl_native_processor *processor;
    int threads;
    gscl_pool *pool;
    gscl_kept_kernel *kernels; /* a list */
} gscl_native_device;

/* The device of a context that this room opened. */
static inline gscl_native_device *gscl_native(const gscl_context *context) {
    return context->device;
}

#endif
