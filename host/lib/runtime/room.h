/* The OpenCL runtime: devices, contexts, programs, buffers, launches, and the clock of stages.
 *
 * It may use: nothing of the library but the sources of the kernels (cl/).
 *
 * In the order in which to read them:
 *   context.h: the context and its error message
 *   stages.h: the names of all stages
 *   opencl.h: checked calls, buffers, launches
 *   device.h: choosing a device
 *   programs.h: building kernels
 *   timing.h: stages and kernels on the clock
 *   open_context.c, result.c: the public functions */
#ifndef GSCL_ROOM_LIB_RUNTIME_H
#define GSCL_ROOM_LIB_RUNTIME_H
#endif
