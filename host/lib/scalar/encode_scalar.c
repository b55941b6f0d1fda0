#include "scalar/encode_scalar.h"

#include <stdlib.h>
#include <string.h>

#include "runtime/timing.h"
#include "scalar/byte_budget.h"
#include "scalar/choose_codes.h"
#include "scalar/kept_codes.h"
#include "scalar/scalar_fit.h"
#include "scalar/search.h"
#include "session/encode_trace.h"

/* The stages of the default profile. */
static gscl_result run_stages(gscl_scalar_state *s, gscl_search_pool *pool) {
    GSCL_TRY(gscl_scalar_fit(s));
    gscl_stage(s->encoder->context, GSCL_STAGE_QUANTISE);
    GSCL_TRY(gscl_scalar_quantise(s));
    GSCL_TRY(gscl_scalar_choose_background(s));
    if (s->has_choice) {
        GSCL_TRY(gscl_scalar_choose_codes(s));
        GSCL_TRY(gscl_scalar_meet_budget(s));
        if (!s->is_searched)
            GSCL_TRY(gscl_scalar_refit_after_drops(s));
        GSCL_TRY(gscl_scalar_search(s, pool));
    }
    return gscl_scalar_trim(s);
}

/* Keeps the result of a search where it is better than those before, by the pixels of the source. */
static gscl_result keep_result(gscl_scalar_state *s, gscl_kept_codes *best) {
    double error;
    GSCL_TRY(gscl_fit_set_level(&s->fit, s->source->first_level));
    GSCL_TRY(gscl_scalar_measure(s, &error));
    return gscl_kept_codes_keep_better(best, s, error);
}

/* Encodes the layer.  A small file is searched from several starts, of which lower efforts make the first ones alone, with
 * the same results. */
static gscl_result run_starts(gscl_scalar_state *s, gscl_encoder *e, const gscl_scalar_plan *plan,
                              gscl_search_pool *pool, gscl_kept_codes *best) {
    const gsf_header header = plan->coded->file.header;
    const double from = e->progress.from, to = e->progress.to;
    gscl_scalar_begin(s, e, plan, 0);
    const int starts = s->starts;
    for (int start = 0; start < starts; start++) {
        if (start > 0) {
            e->trace = NULL; /* the points show one fit */
            gscl_scalar_end(s);
            plan->coded->file.header = header;
            gscl_scalar_begin(s, e, plan, start);
        }
        gscl_progress_stage(&e->progress, from + (to - from) * start / starts,
                            from + (to - from) * (start + 1) / starts);
        GSCL_TRY(run_stages(s, pool));
        if (starts > 1 && s->ends_search)
            GSCL_TRY(keep_result(s, best));
    }
    if (starts > 1)
        GSCL_TRY(gscl_kept_codes_restore(best, s));
    if (s->has_choice)
        gscl_scalar_drop_unused_effects(s);
    return gscl_scalar_trim(s); /* the header's effects count, too */
}

static gscl_result encode_layer(gscl_encoder *e, const gscl_scalar_plan *plan) {
    gscl_scalar_state state;
    gscl_search_pool pool = {0};
    gscl_kept_codes best = {0};
    gscl_encode_trace *trace = e->trace;
    gscl_result result = run_starts(&state, e, plan, &pool, &best);
    e->trace = trace;
    if (result == GSCL_OK)
        result = gscl_trace_coded_image(e, &state.fit, state.coded, state.steps);
    gscl_search_pool_free(&pool);
    gscl_kept_codes_free(&best);
    gscl_scalar_end(&state);
    return result;
}

/* The stages for splats that the coded image has. */
static gscl_result run_given(gscl_scalar_state *s, int steps) {
    GSCL_TRY(gscl_scalar_take_given(s));
    if (steps > 0)
        GSCL_TRY(gscl_scalar_refit(s, 0, steps));
    GSCL_TRY(gscl_scalar_choose_codes(s));
    GSCL_TRY(gscl_scalar_meet_budget(s));
    if (steps > 0)
        GSCL_TRY(gscl_scalar_refit_after_drops(s));
    gscl_scalar_drop_unused_effects(s);
    return gscl_scalar_trim(s);
}

gscl_result gscl_encode_given(gscl_encoder *e, size_t bytes, int steps) {
    const gscl_scalar_plan plan = {.source = &e->source,
                                   .coded = &e->coded,
                                   .preset = &gscl_effort_presets[e->settings.effort],
                                   .target = {.bytes = bytes},
                                   .all = {.bytes = bytes},
                                   .layer = e->coded.file.header.enhancement_layers,
                                   .is_given = true};
    gscl_scalar_state state;
    gscl_scalar_begin(&state, e, &plan, 0);
    const gscl_result result = run_given(&state, steps);
    gscl_scalar_end(&state);
    return result;
}

/* Encodes the layer of the plan on those in e->coded. */
static gscl_result add_layer(gscl_encoder *e, gscl_scalar_plan *plan) {
    const gsf_coded_image *file = &e->coded.file;
    plan->fixed_count = file->header.splat_count;
    gsf_splat *fixed = malloc((plan->fixed_count + 1) * sizeof *fixed);
    if (!fixed)
        return gscl_fail_memory(e->context);
    if (plan->fixed_count > 0)
        memcpy(fixed, file->splats, plan->fixed_count * sizeof *fixed);
    plan->fixed = fixed;
    const gscl_result result = encode_layer(e, plan);
    free(fixed);
    return result;
}

/* The first share of the target that is worth a layer; the last one is the whole. */
static int first_share(const gscl_encoder *e, gscl_size_target target) {
    const struct gscl_scalar_tunables *t = &gscl_scalar_tunables;
    int first = e->settings.progressive ? 0 : GSCL_LAYERS - 1;
    while (first < GSCL_LAYERS - 1 && (target.bytes ? (double)target.bytes * t->layer_shares[first] < t->min_layer_bytes
                                                    : (double)target.splats * t->layer_shares[first] < 1))
        first++;
    return first;
}

/* Each layer is fitted to what those before it leave, so that a part of the file that ends with a layer is about as good
 * as a whole file of that size. */
gscl_result gscl_encode_scalar(gscl_encoder *e, gscl_size_target target) {
    const int first = first_share(e, target), layers = GSCL_LAYERS - first;
    const double from = e->progress.from, to = e->progress.to;
    gscl_scalar_plan plan = {
        .source = &e->source, .coded = &e->coded, .preset = &gscl_effort_presets[e->settings.effort], .all = target};
    e->coded.file.header.enhancement_layers = (uint8_t)(layers - 1);
    for (int layer = 0; layer < layers; layer++) {
        const double share = gscl_scalar_tunables.layer_shares[first + layer];
        gscl_progress_stage(&e->progress, from + (to - from) * layer / layers,
                            from + (to - from) * (layer + 1) / layers);
        plan.layer = (uint32_t)layer;
        plan.is_last = layer == layers - 1;
        plan.target.bytes = (size_t)((double)target.bytes * share);
        plan.target.splats = (size_t)((double)target.splats * share);
        GSCL_TRY(add_layer(e, &plan));
    }
    return GSCL_OK;
}
