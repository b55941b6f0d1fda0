/* The devices of this machine, as their implementations describe them. */
#ifndef GSCL_LIB_DEVICE_LIST_H
#define GSCL_LIB_DEVICE_LIST_H

#include <gscl/gscl.h>

#include "runtime/mapping.h"

struct gscl_backend; /* backend.h */
struct gscl_quirks;  /* opencl/quirks.h */

typedef enum gscl_device_kind {
    GSCL_DEVICE_OTHER,
    GSCL_DEVICE_CPU,  /* of OpenCL */
    GSCL_DEVICE_HOST, /* this processor, with kernels that were compiled with the library */
    GSCL_DEVICE_ACCELERATOR,
    GSCL_DEVICE_GPU
} gscl_device_kind;

typedef struct gscl_listed_device {
    const struct gscl_backend *backend; /* set by the room `device` */
    void *platform, *handle;            /* of the implementation */
    gscl_device_kind kind;
    gscl_device_info info;            /* is_default and why_default are set by the room `device` */
    const gscl_work_shapes *shapes;   /* NULL where the device cannot be queried */
    const struct gscl_quirks *quirks; /* of an OpenCL implementation; NULL where it cannot be queried */
    bool shares_memory;               /* its memory is the host's: an integrated GPU, or a CPU */
    size_t largest_group;             /* work-items of a work-group, at most; 0: no limit */
    char unusable[96];                /* why kernels cannot run on it: "is not available"; empty when they can */
} gscl_listed_device;

typedef struct gscl_device_list {
    size_t count;
    gscl_listed_device *devices;
    char absence[160]; /* why an implementation has no devices: that it is not installed; empty where that is not so */
} gscl_device_list;

/* Makes room for more devices behind the others; NULL without memory. */
gscl_listed_device *gscl_device_list_grow(gscl_device_list *list, size_t more);
void gscl_device_list_free(gscl_device_list *list);

#endif
