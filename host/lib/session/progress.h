/* Progress of an encode: calls the caller's callback, which may cancel the encode. */
#ifndef GSCL_LIB_PROGRESS_H
#define GSCL_LIB_PROGRESS_H

#include "runtime/context.h"

typedef struct gscl_progress_state {
    gscl_progress_callback callback;
    void *opaque;
    double start_s;  /* of the encode, on the clock of gscl_now */
    double first_s;  /* the same of the first report, before which the image is prepared; 0: there was none */
    double from, to; /* share of all stages at which the current one begins and ends */
    double done;     /* share of the encode that was reported last */
    double psnr;     /* of the fit, dB; 0: not known */
    uint32_t splats; /* of the fit */
} gscl_progress_state;

void gscl_progress_begin(gscl_progress_state *progress, const gscl_encode_settings *settings);
/* Begins a stage that covers this share of all stages, 0..1. */
void gscl_progress_stage(gscl_progress_state *progress, double from, double to);
/* Reports that `fraction` of the stage is done.  GSCL_ERROR_CANCELLED when the callback returns false. */
gscl_result gscl_progress_report(gscl_context *context, gscl_progress_state *progress, double fraction);
/* Reports, likewise, that nothing remains. */
gscl_result gscl_progress_end(gscl_context *context, gscl_progress_state *progress);

#endif
