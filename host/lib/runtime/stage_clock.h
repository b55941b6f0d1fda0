/* The stage that is running, and the wall-clock time of each. */
#ifndef GSCL_LIB_STAGE_CLOCK_H
#define GSCL_LIB_STAGE_CLOCK_H

#include "runtime/context.h"

/* Ends the current stage, once the device has finished its work, and begins `stage` (NONE: no stage).
 * Returns the stage that ended, so that a stage within another can restore it. */
gscl_stage_id gscl_stage(gscl_context *context, gscl_stage_id stage);
/* The same, but for what an encode's report alone asks for it does not wait: what a device has yet to do of a stage, which is
 * short and begins often, counts for the one that waits for it.  To be used at both ends of the short stage. */
gscl_stage_id gscl_short_stage(gscl_context *context, gscl_stage_id stage);

/* While the stages are frozen, gscl_stage does nothing: all work counts for the current stage. */
void gscl_stages_freeze(gscl_context *context, bool frozen);

/* Begins to measure the times of stages and, on an OpenCL device, of kernels. */
gscl_result gscl_timing_create(gscl_context *context);

/* An estimate of the seconds until work ends, of which the share `done`, 0..1, took elapsed_s: INFINITY where nothing
 * is done, and 0 only where all is. */
double gscl_remaining_s(double elapsed_s, double done);

#endif
