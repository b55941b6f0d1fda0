#include "session/progress.h"

#include <math.h>

#include "host/system/clock.h"
#include "runtime/queue.h"
#include "runtime/timing.h"
#include "session/tunables.h"

void gscl_progress_begin(gscl_progress_state *p, const gscl_encode_settings *settings) {
    *p = (gscl_progress_state){
        .callback = settings->progress, .opaque = settings->progress_opaque, .start_s = gscl_now(), .to = 1};
}

void gscl_progress_stage(gscl_progress_state *p, double from, double to) {
    p->from = from;
    p->to = to;
}

/* Reports that the share `done` of the encode is done.  Roundings may differ where a stage ends and the next begins. */
static gscl_result report_share(gscl_context *context, gscl_progress_state *p, double done) {
    if (!p->callback)
        return GSCL_OK;
    gscl_flush(context); /* the callback may take its time */
    p->done = fmax(p->done, done);
    const double now = gscl_now(), elapsed = now - p->start_s;
    if (p->first_s == 0)
        p->first_s = now;
    const gscl_progress progress = {.fraction = p->done,
                                    .psnr = p->psnr,
                                    .splats = p->splats,
                                    .elapsed_s = elapsed,
                                    .remaining_s = gscl_remaining_s(now - p->first_s, p->done)};
    if (p->callback(p->opaque, &progress))
        return GSCL_OK;
    return gscl_fail(context, GSCL_ERROR_CANCELLED, "cancelled");
}

gscl_result gscl_progress_report(gscl_context *context, gscl_progress_state *p, double fraction) {
    return report_share(context, p, gscl_session_tunables.stages_share * (p->from + (p->to - p->from) * fraction));
}

gscl_result gscl_progress_end(gscl_context *context, gscl_progress_state *p) {
    return report_share(context, p, 1);
}
