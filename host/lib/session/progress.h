/* Progress of an encode: tells the caller's callback and hears whether to go on. */
#ifndef GSCL_LIB_PROGRESS_H
#define GSCL_LIB_PROGRESS_H

#include "runtime/context.h"

typedef struct gscl_progress_state {
    gscl_progress_callback callback;
    void *opaque;
    double start_s;
    double from, to; /* the part of the whole that the current stage covers */
    double psnr;
    uint32_t splats;
} gscl_progress_state;

void gscl_progress_begin(gscl_progress_state *progress, const gscl_encode_settings *settings);
/* What follows covers this part of the whole. */
void gscl_progress_stage(gscl_progress_state *progress, double from, double to);
/* `fraction` of the stage is done.  GSCL_ERROR_CANCELLED when the caller wants to stop. */
gscl_result gscl_progress_report(gscl_context *context, gscl_progress_state *progress, double fraction);

#endif
