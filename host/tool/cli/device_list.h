/* The devices of this machine, as commands choose among them. */
#ifndef GSCL_TOOL_DEVICE_LIST_H
#define GSCL_TOOL_DEVICE_LIST_H

#include <stdbool.h>

#include <gscl/gscl.h>

/* Whether this is the id of the device "host", or the selector that names it; NULL is neither. */
bool is_host_device(const char *device);

/* Lists the devices that encode, as gscl_list_devices does; where there are none, the list is NULL and no error.  The caller
 * releases it with gscl_free. */
gscl_result list_encoders(gscl_device_info **devices);

/* The device "host" of a list, where the library has kernels for this processor; else NULL. */
const gscl_device_info *find_host(const gscl_device_info *devices);

/* The OpenCL device of a list that comes first when one is needed: the default, or the first; NULL: none. */
const gscl_device_info *find_opencl(const gscl_device_info *devices);

/* Reports that PoCL cannot write to its cache, where that is so and the list has no OpenCL device: PoCL offers none then. */
void report_absent_pocl(const gscl_device_info *devices);

#endif
