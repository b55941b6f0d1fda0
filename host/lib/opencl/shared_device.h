/* What all contexts of a process that have a device open share: an OpenCL context, and the programs that are built in it.  Their
 * queues then work at the same time; drivers for GPUs give a device to one OpenCL context after the other, and reserve the stack
 * of kernels in each. */
#ifndef GSCL_LIB_SHARED_DEVICE_H
#define GSCL_LIB_SHARED_DEVICE_H

#include <CL/cl.h>

#include "runtime/backend.h"

/* Sets the OpenCL context of the context's device, which it creates for the first one. */
gscl_result gscl_shared_device_join(gscl_context *context);
/* Gives it back; what the context has made in it is released before.  Without effect where it has not joined. */
void gscl_shared_device_leave(gscl_context *context);

/* A program of a kind with these options that a context has built: the caller releases it.  Waits for one that another thread is
 * building.  NULL where there is none: then the caller builds it, and calls gscl_shared_program_give in any case. */
cl_program gscl_shared_program_take(gscl_context *context, gscl_program_kind kind, const char *options);
/* Shares the program that the caller was to build.  NULL: it could not be built, and others will try. */
void gscl_shared_program_give(gscl_context *context, gscl_program_kind kind, const char *options, cl_program program);

#endif
