#include "session/encode_trace.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "host/system/clock.h"
#include "runtime/elementary.h"
#include "runtime/timing.h"
#include "session/tunables.h"

void gscl_encode_trace_begin(gscl_encode_trace *t, gscl_context *context, gscl_encode_report *report, bool has_points) {
    *report = (gscl_encode_report){0};
    *t = (gscl_encode_trace){.report = report, .has_points = has_points, .start_s = gscl_now()};
    memcpy(t->before, context->clock.sums, sizeof t->before);
    context->clock.users++;
}

/* Runs and time of a stage since the trace began. */
static gscl_stage_time_sum stage_time(const gscl_encode_trace *t, const gscl_context *context, int stage) {
    const gscl_stage_time_sum *now = &context->clock.sums[stage], *before = &t->before[stage];
    return (gscl_stage_time_sum){.count = now->count - before->count, .seconds = now->seconds - before->seconds};
}

void gscl_encode_trace_end(gscl_encode_trace *t, gscl_context *context) {
    gscl_encode_report *report = t->report;
    if (!report)
        return;
    report->seconds = gscl_now() - t->start_s - stage_time(t, context, GSCL_STAGE_TRACE).seconds;
    for (int stage = GSCL_STAGE_NONE + 1; stage < GSCL_STAGE_TRACE; stage++) {
        gscl_stage_time_sum time = stage_time(t, context, stage);
        if (time.count > 0 && report->stage_count < GSCL_MAX_STAGES)
            report->stages[report->stage_count++] = (gscl_stage_time){
                .name = gscl_stage_name((gscl_stage_id)stage), .count = (uint32_t)time.count, .seconds = time.seconds};
    }
    context->clock.users--;
    gscl_renderer_free(&t->preview);
    t->report = NULL;
}

void gscl_trace_restart(gscl_encoder *e) {
    if (e->trace)
        e->trace->report->trace_count = 0;
}

int gscl_trace_interval(int steps) {
    return steps < gscl_session_tunables.trace_points ? 1 : steps / gscl_session_tunables.trace_points;
}

/* A renderer of the whole image as it is fitted, for `count` splats. */
static gscl_result open_preview(gscl_renderer *preview, const gscl_fit *fit, const gscl_kernel_options *options,
                                size_t count) {
    if (!preview->context)
        GSCL_TRY(gscl_renderer_create(preview, fit->context, options));
    gscl_renderer_set_options(preview, options);
    preview->count = 0;
    GSCL_TRY(gscl_renderer_reserve(preview, count));
    preview->count = (int32_t)count;
    return gscl_renderer_set_view(preview, fit->pyramid.first_level, 0, 0,
                                  gscl_pyramid_width(&fit->pyramid, fit->pyramid.first_level),
                                  gscl_pyramid_height(&fit->pyramid, fit->pyramid.first_level));
}

static gscl_result preview_fit(gscl_renderer *preview, const gscl_fit *fit) {
    const gscl_renderer *r = &fit->renderer;
    GSCL_TRY(open_preview(preview, fit, &r->options, (size_t)r->count));
    GSCL_TRY(gscl_buffer_copy(fit->context, &r->params, &preview->params, 0,
                              (size_t)r->count * GSCL_PARAMS * sizeof(float)));
    GSCL_TRY(gscl_buffer_copy(fit->context, &r->steps, &preview->steps, 0, GSCL_STEP_COUNT * sizeof(float)));
    return gscl_buffer_copy(fit->context, &r->background, &preview->background, 0, (size_t)r->channels * sizeof(float));
}

static gscl_result preview_coded_image(gscl_renderer *preview, const gscl_fit *fit, const gscl_coded_image *coded) {
    gscl_kernel_options options = gscl_coded_image_options(&coded->file.header);
    size_t count = coded->file.header.splat_count;
    float background[4], *params = malloc((count + 1) * GSCL_PARAMS * sizeof *params);
    if (!params)
        return gscl_fail_memory(fit->context);
    gscl_coded_image_params(coded, params, background);
    gscl_result result = open_preview(preview, fit, &options, count);
    if (result == GSCL_OK)
        result = gscl_renderer_set_steps(preview, NULL);
    if (result == GSCL_OK)
        result = gscl_renderer_set_splats(preview, params, count, background);
    free(params);
    return result;
}

/* PSNR of the preview against the source. */
static gscl_result measure_preview(gscl_renderer *preview, gscl_fit *fit, double *psnr) {
    double mse = INFINITY; /* without splats nothing is drawn */
    if (preview->count > 0) {
        GSCL_TRY(gscl_renderer_render(preview));
        GSCL_TRY(gscl_fit_mse_against_source(fit, &preview->image, &mse));
    }
    *psnr = isfinite(mse) ? -10 * gscl_log10(mse) : 0;
    return GSCL_OK;
}

static gscl_result trace_add_point(gscl_encoder *e, gscl_fit *fit, const gscl_coded_image *coded, int steps) {
    gscl_encode_trace *t = e->trace;
    if (!t || !t->has_points || e->context->clock.frozen || t->report->trace_count == GSCL_MAX_TRACE_POINTS)
        return GSCL_OK;
    double paused_s = stage_time(t, e->context, GSCL_STAGE_TRACE).seconds;
    gscl_stage_id stage = gscl_stage(e->context, GSCL_STAGE_TRACE);
    gscl_trace_point *point = &t->report->trace[t->report->trace_count];
    GSCL_TRY(coded ? preview_coded_image(&t->preview, fit, coded) : preview_fit(&t->preview, fit));
    *point = (gscl_trace_point){.stage = gscl_stage_name(stage),
                                .steps = (uint32_t)steps,
                                .splats = (uint32_t)t->preview.count,
                                .seconds = e->context->clock.start_s - t->start_s - paused_s};
    GSCL_TRY(measure_preview(&t->preview, fit, &point->psnr));
    t->report->trace_count++;
    gscl_stage(e->context, stage);
    return GSCL_OK;
}

gscl_result gscl_trace_fit(gscl_encoder *e, gscl_fit *fit, int steps) {
    return trace_add_point(e, fit, NULL, steps);
}

gscl_result gscl_trace_coded_image(gscl_encoder *e, gscl_fit *fit, const gscl_coded_image *coded, int steps) {
    return trace_add_point(e, fit, coded, steps);
}
