#include "scalar/scalar_progress.h"

#include <math.h>

#include "runtime/elementary.h"
#include "runtime/queue.h"
#include "scalar/fit_levels.h"

static const struct gscl_scalar_tunables *const tunables = &gscl_scalar_tunables;

/* ---- Fit ---- */

/* What this share of the steps takes, in steps at full size. */
static double fit_work(const gscl_scalar_state *s, double fraction) {
    double ends[3], from = 0, work = 0;
    gscl_scalar_level_ends(s, ends);
    for (int level = 2; level >= 0; level--) {
        const double to = fmax(fmin(fraction, ends[level]), from);
        work += (to - from) * tunables->step_work[gscl_scalar_limited_level(s, level)];
        from = to;
    }
    return s->steps * work;
}

/* Steps of large images take so long that the device is waited for, which otherwise has many of them to do. */
gscl_result gscl_scalar_report_step(gscl_scalar_state *s, int step) {
    gscl_progress_state *progress = &s->encoder->progress;
    const bool is_plain = gscl_scalar_has_squared_error(s) && s->fit.model_level < 0;
    const bool is_large = s->source_pixels >= tunables->min_report_wait_pixels;
    const double loss = s->fit.known_loss; /* of some steps ago */
    const int interval = is_large ? tunables->large_report_interval : tunables->report_interval;
    if (!progress->callback || step % interval != 0)
        return GSCL_OK;
    if (is_large)
        GSCL_TRY(gscl_finish(s->encoder->context));
    progress->psnr = is_plain && loss > 0 ? -10 * gscl_log10(loss) : 0;
    progress->splats = (uint32_t)s->fit.renderer.count;
    const double share = fit_work(s, (double)step / s->steps) / fit_work(s, 1);
    return gscl_progress_report(s->encoder->context, progress, s->fit_end * share);
}

/* ---- Passes ---- */

/* Those that are still expected, with what they scan for in passes that do not scan. */
static double passes_left(const gscl_scalar_state *s) {
    const int planned = 1 + s->passes - s->passes_done;
    if (planned > 0) {
        const int scans = s->textures ? (planned + tunables->scan_interval - 2) / tunables->scan_interval : 0;
        return planned + scans * tunables->scan_work + (s->bytes ? tunables->expected_final_passes : 0);
    }
    const double filled = s->bytes ? (double)s->size / (double)s->bytes : 1;
    if (filled >= s->full_share && filled <= 1)
        return 0;
    return fmin(1 + fabs(filled - 1) / tunables->expected_change, tunables->expected_final_passes);
}

void gscl_scalar_expect_fit_end(gscl_scalar_state *s) {
    const double fit = fit_work(s, 1);
    const double passes = s->has_choice ? tunables->pass_work[s->finest] * passes_left(s) : 0;
    s->fit_end = fit / (fit + passes);
}

gscl_result gscl_scalar_report_pass(gscl_scalar_state *s, bool scan_textures) {
    gscl_progress_state *progress = &s->encoder->progress;
    s->passes_done++;
    s->pass_work_done += 1 + (scan_textures ? tunables->scan_work : 0);
    progress->splats = s->coded->file.header.splat_count;
    const double done = s->pass_work_done / (s->pass_work_done + passes_left(s));
    return gscl_progress_report(s->encoder->context, progress, s->fit_end + (s->passes_end - s->fit_end) * done);
}
