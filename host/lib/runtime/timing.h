/* Times of the stages of an encode or decode (wall clock) and of kernels (the device's clock).
 *
 * Nothing is measured, and nothing waits, unless gscl_context_settings.timing or an encode's report
 * (session/encode_trace.h) asks for it. */
#ifndef GSCL_LIB_TIMING_H
#define GSCL_LIB_TIMING_H

#include <gscl/measure.h>

#include "runtime/stage_clock.h"

/* The timing of a kernel that is being launched with `items` work-items; NULL where kernels are not measured. */
gscl_timing *gscl_timing_begin(gscl_context *context, const char *kernel_name, size_t items);
/* Adds one run of a kernel. */
void gscl_timing_add(gscl_context *context, gscl_timing *timing, double seconds);

/* Time of all kernels since the timings were reset, seconds. */
double gscl_kernel_seconds(const gscl_context *context);
/* Sorts samples, the smallest first. */
void gscl_sort_samples(double *samples, size_t count);

void gscl_timing_free(gscl_context *context);

#endif
