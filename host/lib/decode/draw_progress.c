#include "decode/draw_progress.h"

#include "host/system/clock.h"
#include "runtime/context.h"
#include "runtime/stage_clock.h"

gscl_draw_progress gscl_draw_progress_begin(const gscl_decode_settings *s, const gscl_coded_image *coded,
                                            double start_s) {
    if (!s->progress)
        return (gscl_draw_progress){.callback = NULL};
    return (gscl_draw_progress){.callback = s->progress,
                                .opaque = s->progress_opaque,
                                .start_s = start_s,
                                .splats = coded->file.header.splat_count};
}

gscl_result gscl_draw_progress_report(gscl_context *context, const gscl_draw_progress *p, const gscl_frame *f,
                                      uint32_t rows) {
    if (!p->callback)
        return GSCL_OK;
    const double done = (double)rows / f->height, elapsed = gscl_now() - p->start_s;
    const gscl_progress progress = {
        .fraction = done, .splats = p->splats, .elapsed_s = elapsed, .remaining_s = gscl_remaining_s(elapsed, done)};
    if (p->callback(p->opaque, &progress))
        return GSCL_OK;
    return gscl_fail(context, GSCL_ERROR_CANCELLED, "cancelled");
}
