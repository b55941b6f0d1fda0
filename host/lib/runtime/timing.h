/* Times of the stages of an encode or decode (wall clock) and of kernels (the device's clock).
 *
 * Nothing is measured, and nothing waits, unless gscl_context_settings.timing or an encode's report
 * (session/encode_trace.h) asks for it. */
#ifndef GSCL_LIB_TIMING_H
#define GSCL_LIB_TIMING_H

#include <gscl/measure.h>

#include "runtime/context.h"

/* Ends the current stage, once the device has finished its work, and begins `stage` (NONE: no stage).
 * Returns the stage that ended, so that a stage within another can restore it. */
gscl_stage_id gscl_stage(gscl_context *context, gscl_stage_id stage);

/* While the stages are frozen, gscl_stage does nothing: all work counts for the current stage. */
void gscl_stages_freeze(gscl_context *context, bool frozen);

/* Where to put the event of a kernel that is being launched; NULL when nothing is measured. */
cl_event *gscl_timing_event(gscl_context *context, cl_kernel kernel);

/* Time of all kernels since the timings were reset, seconds. */
double gscl_kernel_seconds(const gscl_context *context);
/* Sorts samples, the smallest first. */
void gscl_sort_samples(double *samples, size_t count);

/* Seconds on a clock that only goes forward. */
double gscl_now(void);

gscl_result gscl_timing_create(gscl_context *context);
void gscl_timing_free(gscl_context *context);

#endif
