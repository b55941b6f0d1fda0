/* All devices of this machine, of every implementation. */
#ifndef GSCL_LIB_DEVICE_DEVICE_LIST_H
#define GSCL_LIB_DEVICE_DEVICE_LIST_H

#include "runtime/device_list.h"

/* Lists the devices of all implementations, those that cannot be used too.  At most one is the default, and it can be used: a
 * GPU, of several one with memory of its own, then the one with the most memory, then the most compute units, then the first;
 * else the first accelerator; else the processor with kernels that were compiled with the library, unless the GPU mapping is
 * asked for, which it does not have; else the first other device.  Fails when the host has no memory left; the list may be freed
 * in either case. */
gscl_result gscl_device_list_create(gscl_device_list *list, gscl_mapping mapping);

/* Lists GSCL_HOST_DEVICE alone, if the library has kernels for it, and leaves OpenCL alone: its loader takes a tenth of a second,
 * and does not work in a process that was forked from one that used it.  None is marked as the default.  Fails as
 * gscl_device_list_create does. */
gscl_result gscl_device_list_create_host(gscl_device_list *list);

#endif
