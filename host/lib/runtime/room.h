/* The OpenCL runtime: devices, contexts, programs, buffers, launches, and times of stages and kernels.
 *
 * It may use: nothing of the library but the sources of the kernels (cl/).
 *
 * In the order in which to read them:
 *   context.h: the context and its error message
 *   stages.h: the names of all stages
 *   text.h, cl_names.h: texts of fixed size, names of OpenCL's errors and kernels
 *   allocate.h: memory of sizes that 32 bits may not count
 *   vectors.h: vectors in the layout of kernels
 *   stage_clock.h: times of stages
 *   queue.h: waiting for the device
 *   timing.h: times of kernels
 *   opencl.h: checked calls, buffers, launches
 *   staging.h: copies to the device without waiting
 *   quirks.h: what some OpenCL implementations need otherwise
 *   device_list.h, device.h: listing and choosing devices
 *   kernel_options.h, mapping.h, build_options.h: the options that kernels are specialised for
 *   program.h, kernel_sources.h: building a program
 *   prefetch.h: building programs ahead of their use
 *   programs.h: looking kernels up
 *   binary_store.h, binary_store_trim.h, program_cache.h: programs that are kept from process to process
 *   tunables.h: the numbers that were found by trying
 *   struct_size.h: structs of programs that were compiled with an older header
 *   open_device.h: opening the OpenCL device of a context
 *   open_context.c, result.c: the public functions */
#ifndef GSCL_ROOM_LIB_RUNTIME_H
#define GSCL_ROOM_LIB_RUNTIME_H
#endif
