/* Which devices there are, and the public functions that list, open and query them.
 *
 * It may use: runtime, and the implementations of devices (native, opencl).
 *
 * In the order in which to read them:
 *   open_context.c: the public functions of contexts
 *   backends.h: the implementations that this library was built with
 *   device_list.h: the devices of all of them, and which is the default
 *   open_device.h: choosing, opening and closing a device
 *   host_device.h: the device "host" where it only decodes
 *   without_kernels.c: all this in a library that has no implementation */
#ifndef GSCL_ROOM_LIB_DEVICE_H
#define GSCL_ROOM_LIB_DEVICE_H
#endif
