/* The processor as an implementation of devices: kernels that were compiled with the library (cl/native.py), and threads.
 *
 * It may use: runtime.  Only the room `device` uses it.
 *
 * In the order in which to read them:
 *   backend.h: the functions of this room that runtime/backend.h asks for
 *   programs.h: the compiled kernels of each processor, and which one serves which options
 *   processor.h: the kernels for the processor that this is; own_processor.c prints their name while building
 *   machine.h: the processors and the memory that this process has
 *   pool.h: threads that share a launch; wasm_pool.c takes the place of both in WebAssembly
 *   native_device.h, launch.h: the device of a context, its kernels and launches
 *   memory.h: its memory
 *   tunables.h: the numbers that were found by trying */
#ifndef GSCL_ROOM_LIB_NATIVE_H
#define GSCL_ROOM_LIB_NATIVE_H
#endif
