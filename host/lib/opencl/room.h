/* OpenCL as an implementation of devices: all that has a type of OpenCL.
 *
 * It may use: runtime and the sources of the kernels (cl/).  Only the room `device` uses it.
 *
 * In the order in which to read them:
 *   backend.h: the functions of this room that runtime/backend.h asks for
 *   library.h: the OpenCL library of the machine, opened at run time
 *   cl_error.h: checked calls, names of errors
 *   quirks.h: what some OpenCL implementations need otherwise
 *   device_list.h: the OpenCL devices of the machine
 *   opencl_device.h, open.h: the device of a context, opening and closing it
 *   shared_device.h: what contexts of a device share
 *   memory.h, pinned.h: memory of the device, and reading large results from it
 *   launch.h, kernel_times.h: launches, and the times that they take
 *   build_options.h: the options that kernels are specialised for, as macros
 *   program.h, kernel_sources.h: building a program
 *   prefetch.h: building programs ahead of their use
 *   programs.h: looking kernels up
 *   binary_store.h, binary_store_trim.h, program_cache.h: programs that are kept from process to process, but for Windows
 *   (without_program_cache.c)
 *   tunables.h: the numbers that were found by trying */
#ifndef GSCL_ROOM_LIB_OPENCL_H
#define GSCL_ROOM_LIB_OPENCL_H
#endif
