#include "report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "constants.h"
#include "timing.h"

#define ROUNDS_OF_FIT 24 /* besides the passes that follow */

static const char aside[] = "measuring rounds";

void gscl_recorder_begin(gscl_recorder *r, gscl_context *context, gscl_encode_report *report, bool rounds) {
    *report = (gscl_encode_report){0};
    *r = (gscl_recorder){.report = report, .rounds = rounds, .start_s = gscl_now()};
    context->recorder = r;
}

void gscl_recorder_end(gscl_recorder *r, gscl_context *context) {
    if (!r->report)
        return;
    r->report->seconds = gscl_now() - r->start_s - r->aside_s;
    gscl_renderer_free(&r->probe);
    context->recorder = NULL;
    r->report = NULL;
}

static gscl_stage_time *row_of(gscl_encode_report *report, const char *name) {
    for (uint32_t i = 0; i < report->stage_count; i++)
        if (strcmp(report->stages[i].name, name) == 0)
            return &report->stages[i];
    if (report->stage_count == GSCL_MAX_STAGES)
        return NULL;
    report->stages[report->stage_count] = (gscl_stage_time){.name = name};
    return &report->stages[report->stage_count++];
}

const char *gscl_recorder_stage(gscl_recorder *r, const char *name, double now_s) {
    const char *ended = r->stage;
    double seconds = now_s - r->stage_start_s;
    gscl_stage_time *row = ended && ended != aside ? row_of(r->report, ended) : NULL;
    if (ended == aside)
        r->aside_s += seconds;
    if (row) {
        row->seconds += seconds;
        row->count++;
    }
    r->stage = name;
    r->stage_start_s = now_s;
    return ended;
}

void gscl_report_restart(gscl_encoder *e) {
    if (e->context->recorder)
        e->context->recorder->report->round_count = 0;
}

int gscl_report_interval(int steps) {
    return steps < ROUNDS_OF_FIT ? 1 : steps / ROUNDS_OF_FIT;
}

/* A renderer of the whole image as it is fitted, for `count` splats. */
static gscl_result open_probe(gscl_renderer *probe, const gscl_fit *fit, const gscl_kernel_options *options,
                              size_t count) {
    if (!probe->context)
        GSCL_TRY(gscl_renderer_create(probe, fit->context, options));
    probe->options = *options;
    probe->count = 0;
    GSCL_TRY(gscl_renderer_reserve(probe, count));
    probe->count = (cl_int)count;
    return gscl_renderer_set_view(probe, fit->first_level, 0, 0, gscl_level_size(fit->width, fit->first_level),
                                  gscl_level_size(fit->height, fit->first_level));
}

static gscl_result take_fit(gscl_renderer *probe, const gscl_fit *fit) {
    const gscl_renderer *r = &fit->renderer;
    GSCL_TRY(open_probe(probe, fit, &r->options, (size_t)r->count));
    GSCL_TRY(
        gscl_buffer_copy(fit->context, &r->params, &probe->params, 0, (size_t)r->count * GSCL_PARAMS * sizeof(float)));
    GSCL_TRY(gscl_buffer_copy(fit->context, &r->steps, &probe->steps, 0, GSCL_STEP_COUNT * sizeof(float)));
    return gscl_buffer_copy(fit->context, &r->background, &probe->background, 0, (size_t)r->channels * sizeof(float));
}

static gscl_result take_picture(gscl_renderer *probe, const gscl_fit *fit, const gscl_picture *picture) {
    gscl_kernel_options options = gscl_picture_options(&picture->file.header);
    size_t count = picture->file.header.splat_count;
    float background[4], *params = malloc((count + 1) * GSCL_PARAMS * sizeof *params);
    if (!params)
        return gscl_fail(fit->context, GSCL_ERROR_OUT_OF_MEMORY, "out of memory");
    gscl_picture_params(picture, params, background);
    gscl_result result = open_probe(probe, fit, &options, count);
    if (result == GSCL_OK)
        result = gscl_renderer_set_steps(probe, NULL);
    if (result == GSCL_OK)
        result = gscl_renderer_set_splats(probe, params, count, background);
    free(params);
    return result;
}

/* What the probe shows, against the image. */
static gscl_result measure_probe(gscl_renderer *probe, gscl_fit *fit, double *psnr) {
    double mse = INFINITY; /* of no splats: never drawn */
    if (probe->count > 0) {
        GSCL_TRY(gscl_renderer_render(probe));
        GSCL_TRY(gscl_fit_distance(fit, &probe->image, &mse));
    }
    *psnr = isfinite(mse) ? -10 * log10(mse) : 0;
    return GSCL_OK;
}

static gscl_result add_round(gscl_encoder *e, gscl_fit *fit, const gscl_picture *picture, int steps) {
    gscl_recorder *r = e->context->recorder;
    if (!r || !r->rounds || e->context->stages_frozen || r->report->round_count == GSCL_MAX_ROUNDS)
        return GSCL_OK;
    const char *stage = gscl_stage(e->context, aside);
    gscl_round *round = &r->report->rounds[r->report->round_count];
    double at_s = r->stage_start_s - r->start_s - r->aside_s;
    GSCL_TRY(picture ? take_picture(&r->probe, fit, picture) : take_fit(&r->probe, fit));
    *round = (gscl_round){
        .stage = stage ? stage : "", .steps = (uint32_t)steps, .splats = (uint32_t)r->probe.count, .seconds = at_s};
    GSCL_TRY(measure_probe(&r->probe, fit, &round->psnr));
    r->report->round_count++;
    gscl_stage(e->context, stage);
    return GSCL_OK;
}

gscl_result gscl_report_fit(gscl_encoder *e, gscl_fit *fit, int steps) {
    return add_round(e, fit, NULL, steps);
}

gscl_result gscl_report_picture(gscl_encoder *e, gscl_fit *fit, int steps) {
    return add_round(e, fit, &e->picture, steps);
}
