/* The OpenCL device of a context: its handles, and the programs that were built for it. */
#ifndef GSCL_LIB_OPENCL_DEVICE_H
#define GSCL_LIB_OPENCL_DEVICE_H

#include <CL/cl.h>

#include "opencl/quirks.h"
#include "runtime/context.h"

struct gscl_shared_device; /* shared_device.c */
struct gscl_program;       /* program.h */
struct gscl_prefetch;      /* prefetch.c */
struct gscl_kernel_times;  /* kernel_times.c */

/* Memory of the host that the device copies into directly (pinned.h). */
typedef struct gscl_pinned_memory {
    cl_mem memory; /* NULL: not allocated yet */
    char *bytes;   /* where it is mapped */
} gscl_pinned_memory;

typedef struct gscl_opencl_device {
    cl_platform_id platform;
    cl_device_id id;
    struct gscl_shared_device *shared;    /* with others that have the device open; NULL: not joined yet */
    struct gscl_opencl_device *next_user; /* of the shared device, which guards it */
    const gscl_context *owner;
    cl_context context; /* of the shared device */
    cl_command_queue queue;
    const gscl_quirks *quirks;       /* of the implementation */
    bool own_builtins;               /* programs declare built-in functions with cl/builtins.h (program.c) */
    struct gscl_program *programs;   /* built so far, a list */
    struct gscl_prefetch *prefetch;  /* programs that another thread builds, or NULL */
    char *cache_folder;              /* where built programs are kept (program_cache.h), or NULL */
    struct gscl_kernel_times *times; /* of launches, where they are measured; else NULL */
    bool has_pinned_reads;           /* large reads go through pinned memory: the device's memory is not the host's */
    gscl_pinned_memory pinned;
} gscl_opencl_device;

/* The device of a context that this room opened. */
static inline gscl_opencl_device *gscl_opencl(const gscl_context *context) {
    return context->device;
}

#endif
