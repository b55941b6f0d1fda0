#include "session/progress.h"

#include "runtime/timing.h"

void gscl_progress_begin(gscl_progress_state *p, const gscl_encode_settings *settings) {
    *p = (gscl_progress_state){
        .callback = settings->progress, .opaque = settings->progress_opaque, .start_s = gscl_now(), .to = 1};
}

void gscl_progress_stage(gscl_progress_state *p, double from, double to) {
    p->from = from;
    p->to = to;
}

gscl_result gscl_progress_report(gscl_context *context, gscl_progress_state *p, double fraction) {
    if (!p->callback)
        return GSCL_OK;
    double done = p->from + (p->to - p->from) * fraction, elapsed = gscl_now() - p->start_s;
    gscl_progress progress = {.fraction = done,
                              .psnr = p->psnr,
                              .splats = p->splats,
                              .elapsed_s = elapsed,
                              .remaining_s = done > 1e-3 ? elapsed * (1 - done) / done : 0};
    if (p->callback(p->opaque, &progress))
        return GSCL_OK;
    return gscl_fail(context, GSCL_ERROR_CANCELLED, "cancelled");
}
