/* What all devices share: contexts, buffers, launches, waits, times of stages and kernels.  backend.h is the interface that an
 * implementation of devices fills.  And what all other rooms may compute with.
 *
 * It may use: nothing of the library, and of cl/ the constants.
 *
 * In the order in which to read them:
 *   context.h: the context and its error message
 *   stages.h: the names of all stages
 *   text.h: texts of fixed size
 *   allocate.h: memory of sizes that 32 bits may not count
 *   real.h: the type of the numbers that place and shape splats
 *   elementary.h: exp, log, sin and others, with the same bits on every machine
 *   stage_clock.h: times of stages
 *   kernel_options.h, mapping.h: the options that kernels are specialised for, and how they share work
 *   device_list.h: the devices of the machine
 *   backend.h: what an implementation of devices does
 *   queue.h: waiting for the device
 *   timing.h: times of kernels
 *   buffer.h: memory of the device
 *   launch.h: looking kernels up, and launching them
 *   vectors.h: vectors in the layout of kernels
 *   staging.h: copies to the device without waiting
 *   tunables.h: the numbers that were found by trying
 *   struct_size.h: structs of programs that were compiled with an older header
 *   result.c: public functions that need no context */
#ifndef GSCL_ROOM_LIB_RUNTIME_H
#define GSCL_ROOM_LIB_RUNTIME_H
#endif
