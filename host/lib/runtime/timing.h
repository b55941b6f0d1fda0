/* Times of the stages of an encode or decode (wall clock) and of kernels (the device's clock).
 *
 * Nothing is measured, and nothing waits, unless gscl_context_settings.timing or an encode's report
 * (session/encode_trace.h) asks for it. */
#ifndef GSCL_LIB_TIMING_H
#define GSCL_LIB_TIMING_H

#include <CL/cl.h>
#include <gscl/measure.h>

#include "runtime/stage_clock.h"

/* Waits for the device and adds up the times of its kernels, where they are measured (gscl_context.settle). */
void gscl_timing_settle(gscl_context *context);

/* Where to put the event of a kernel that is being launched with `items` work-items; NULL when nothing is measured. */
cl_event *gscl_timing_event(gscl_context *context, cl_kernel kernel, size_t items);

/* Adds the time of a launch that may have built its kernel, where kernels are measured. */
void gscl_timing_add_build(gscl_context *context, cl_kernel kernel, double seconds);

/* Time of all kernels since the timings were reset, seconds. */
double gscl_kernel_seconds(const gscl_context *context);
/* Sorts samples, the smallest first. */
void gscl_sort_samples(double *samples, size_t count);

void gscl_timing_free(gscl_context *context);

#endif
