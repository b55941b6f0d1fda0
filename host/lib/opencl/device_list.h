/* All OpenCL devices of this machine and their properties. */
#ifndef GSCL_LIB_OPENCL_DEVICE_LIST_H
#define GSCL_LIB_OPENCL_DEVICE_LIST_H

#include "runtime/device_list.h"

/* Appends the devices of all platforms, those that cannot be used too.  Fails when the host has no memory left. */
gscl_result gscl_opencl_list(gscl_device_list *list);

#endif
