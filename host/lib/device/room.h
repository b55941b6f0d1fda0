/* Which devices there are, and the public functions that list, open and query them.
 *
 * It may use: runtime, and the implementations of devices (opencl).
 *
 * In the order in which to read them:
 *   open_context.c: the public functions of contexts
 *   device_list.h: the devices of all implementations, and which is the default
 *   open_device.h: choosing, opening and closing a device
 *   host_device.h: the device "host", which only decodes
 *   without_opencl.c: all this in a library without OpenCL */
#ifndef GSCL_ROOM_LIB_DEVICE_H
#define GSCL_ROOM_LIB_DEVICE_H
#endif
