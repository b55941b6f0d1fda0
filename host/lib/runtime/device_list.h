/* All OpenCL devices of this machine and their properties. */
#ifndef GSCL_LIB_DEVICE_LIST_H
#define GSCL_LIB_DEVICE_LIST_H

#include <CL/cl.h>
#include <gscl/gscl.h>

#include "runtime/quirks.h"

typedef struct gscl_listed_device {
    cl_platform_id platform;
    cl_device_id device;
    cl_device_type type;
    gscl_device_info info;
    const gscl_quirks *quirks; /* of its platform; NULL where that cannot be queried */
    char unusable[96];         /* why kernels cannot run on it: "is not available"; empty when they can */
} gscl_listed_device;

typedef struct gscl_device_list {
    size_t count;
    gscl_listed_device *devices;
} gscl_device_list;

/* Lists the devices of all platforms, those that cannot be used too.  At most one is the default, and it can be used.
 * Fails when the host has no memory left; the list may be freed in either case. */
gscl_result gscl_device_list_create(gscl_device_list *list);
void gscl_device_list_free(gscl_device_list *list);

#endif
