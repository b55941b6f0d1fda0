/* Times of kernels, on the device's clock. */
#ifndef GSCL_LIB_OPENCL_KERNEL_TIMES_H
#define GSCL_LIB_OPENCL_KERNEL_TIMES_H

#include <CL/cl.h>
#include <gscl/measure.h>

#include "runtime/context.h"

/* What the device's `times` need. */
gscl_result gscl_opencl_times_create(gscl_context *context);
void gscl_opencl_times_free(gscl_context *context);

/* Where to put the event of a launch whose time is added to `timing`. */
cl_event *gscl_opencl_time(gscl_context *context, gscl_timing *timing);
/* Adds the times of launches up (gscl_backend). */
void gscl_opencl_collect_times(gscl_context *context);

#endif
