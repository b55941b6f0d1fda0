#include "codebook/codebook_fit.h"

#include <math.h>
#include <stdlib.h>

#include "cl/constants.h"
#include "codebook/codebook_cluster.h"
#include "codebook/codebook_order.h"
#include "codebook/codebook_step.h"
#include "codebook/tunables.h"
#include "decode/quantise.h"
#include "fit/density.h"
#include "runtime/elementary.h"
#include "runtime/timing.h"
#include "session/encode_trace.h"

#define REPORT_INTERVAL 25 /* steps */

static int straight_through_start(const gscl_codebook_state *s) {
    return (int)(s->plan.steps * gscl_codebook_tunables.straight_through_start);
}

static double rate_at(double fraction) {
    const struct gscl_codebook_tunables *t = &gscl_codebook_tunables;
    const double range = 1 - t->decay_start, fall = (1 - t->final_rate) * 0.5;
    return t->learning_rate *
           (fraction < t->decay_start
                ? 1.0
                : t->final_rate + fall * (1 + gscl_cos(3.14159265 * (fraction - t->decay_start) / range)));
}

static int level_at(double fraction, int first_level) {
    const struct gscl_codebook_tunables *t = &gscl_codebook_tunables;
    return first_level + (fraction < t->quarter_size_end ? 2 : fraction < t->half_size_end ? 1 : 0);
}

gscl_result gscl_codebook_report_progress(gscl_codebook_state *s, double fraction) {
    gscl_encoder *e = s->encoder;
    if (!e->progress.callback)
        return GSCL_OK;
    e->progress.splats = (uint32_t)s->fit.renderer.count;
    return gscl_progress_report(e->context, &e->progress, fraction);
}

/* ---- The order of drawing ---- */

typedef struct size_key {
    float size; /* ln of the longer axis */
    size_t splat;
} size_key;

static int compare_keys(const void *a, const void *b) {
    const size_key *p = a, *q = b;
    if (p->size != q->size)
        return p->size < q->size ? 1 : -1;
    return p->splat < q->splat ? -1 : p->splat > q->splat;
}

/* Reads the splats and lists in `order` those that are opaque enough to keep, large ones first. */
static gscl_result order_by_size(gscl_fit *fit, float *params, size_key *keys, size_t *order, size_t *kept) {
    const size_t count = (size_t)fit->renderer.count;
    *kept = 0;
    GSCL_TRY(gscl_fit_read(fit, params));
    for (size_t i = 0; i < count; i++) {
        const float *p = params + i * GSCL_PARAMS;
        if (p[GSCL_OPACITY] > gscl_codebook_tunables.min_opacity)
            keys[(*kept)++] = (size_key){fmaxf(p[GSCL_LOG_S1], p[GSCL_LOG_S2]), i};
    }
    qsort(keys, *kept, sizeof *keys, compare_keys);
    for (size_t i = 0; i < *kept; i++)
        order[i] = keys[i].splat;
    return GSCL_OK;
}

/* Puts large splats in the back and drops nearly transparent ones (P7). */
static gscl_result sort_by_size(gscl_fit *fit) {
    const size_t count = (size_t)fit->renderer.count;
    float *params = malloc((count + 1) * GSCL_PARAMS * sizeof *params);
    size_key *keys = malloc((count + 1) * sizeof *keys);
    size_t kept = 0, *order = malloc((count + 1) * sizeof *order);
    gscl_result result =
        params && keys && order ? order_by_size(fit, params, keys, order, &kept) : gscl_fail_memory(fit->context);
    if (result == GSCL_OK && kept > 0)
        result = gscl_fit_reorder(fit, order, kept);
    free(params);
    free(keys);
    free(order);
    return result;
}

/* ---- The free fit ---- */

/* Adds the splats that densification round `round` should have. */
static gscl_result densify_to_round(gscl_codebook_state *s, int round) {
    const struct gscl_codebook_tunables *t = &gscl_codebook_tunables;
    const size_t first = s->plan.first_splats, added = s->plan.splats - first;
    const size_t target = first + added * (size_t)round / (size_t)t->densification_rounds;
    const size_t count = (size_t)s->fit.renderer.count;
    if (target > count) {
        GSCL_TRY(gscl_density_densify(&s->fit, (target - count) / (size_t)t->density_control_divisor));
        GSCL_TRY(gscl_density_grow(&s->fit, target - (size_t)s->fit.renderer.count, &s->encoder->random));
    }
    return sort_by_size(&s->fit);
}

static gscl_result set_level(gscl_codebook_state *s, int level) {
    gscl_stage(s->encoder->context, gscl_fit_stage(&s->fit, level));
    return gscl_fit_set_level(&s->fit, level);
}

/* Changes the level and the number of splats before step `step`; `round`: densification rounds done. */
static gscl_result prepare_step(gscl_codebook_state *s, int step, int *round) {
    const struct gscl_codebook_tunables *t = &gscl_codebook_tunables;
    const double fraction = (double)step / s->plan.steps;
    const int level = level_at(fraction, s->encoder->source.first_level);
    if (step == 0 || level != s->fit.level)
        GSCL_TRY(set_level(s, level));
    if (step == 0)
        GSCL_TRY(gscl_density_seed(&s->fit, s->plan.first_splats, &s->encoder->random));
    while (*round < t->densification_rounds &&
           fraction >= t->densification_end * (*round + 1) / t->densification_rounds)
        GSCL_TRY(densify_to_round(s, ++*round));
    if (step == (int)(t->replenish_at * s->plan.steps))
        GSCL_TRY(densify_to_round(s, t->densification_rounds));
    return step % t->sort_interval == 0 ? sort_by_size(&s->fit) : GSCL_OK;
}

static gscl_result run_steps(gscl_codebook_state *s, int end) {
    int round = 0;
    for (int step = 0; step < end; step++) {
        const double fraction = (double)step / s->plan.steps;
        GSCL_TRY(prepare_step(s, step, &round));
        GSCL_TRY(gscl_fit_step(&s->fit, (float)rate_at(fraction), 1));
        if (step % REPORT_INTERVAL == 0)
            GSCL_TRY(gscl_codebook_report_progress(s, GSCL_CODEBOOK_FIT_SHARE * fraction));
        if ((step + 1) % gscl_trace_interval(s->plan.steps) == 0)
            GSCL_TRY(gscl_trace_fit(s->encoder, &s->fit, step + 1));
    }
    return sort_by_size(&s->fit);
}

static gscl_result create_fit(gscl_codebook_state *s) {
    gscl_encoder *e = s->encoder;
    gsf_coded_image *file = &e->coded.file;
    gscl_kernel_options options = gscl_coded_image_options(&file->header);
    options.loss = e->loss_kind;
    GSCL_TRY(gscl_fit_create(&s->fit, e->context, &options, e->source.image_width, e->source.image_height,
                             e->source.first_level, e->source.planes));
    gscl_encoder_release_source(e);
    for (int k = 0; k < s->fit.renderer.channels; k++)
        file->background[k] = gscl_quantise_background(&file->header, s->fit.background[k]);
    return GSCL_OK;
}

gscl_result gscl_codebook_fit_freely(gscl_codebook_state *s) {
    GSCL_TRY(create_fit(s));
    GSCL_TRY(run_steps(s, straight_through_start(s)));
    GSCL_TRY(gscl_fit_set_level(&s->fit, s->encoder->source.first_level));
    GSCL_TRY(gscl_fit_rendering_error(&s->fit, &s->fit_error));
    gscl_log(s->encoder->context, GSCL_LOG_DEBUG, "free fit: %d of %zu splats", (int)s->fit.renderer.count,
             s->plan.splats);
    return GSCL_OK;
}

/* ---- The straight-through fit ---- */

static gscl_result cluster_and_sort(gscl_codebook_state *s, bool warm) {
    const int *words = s->plan.words;
    GSCL_TRY(gscl_codebook_cluster(&s->codebook, words[GSCL_BOOK_SHAPE], words[GSCL_BOOK_COLOUR], warm,
                                   &s->encoder->random));
    return gscl_codebook_sort(&s->codebook, &s->encoder->coded);
}

gscl_result gscl_codebook_fit_straight_through(gscl_codebook_state *s) {
    const struct gscl_codebook_tunables *t = &gscl_codebook_tunables;
    const int first = straight_through_start(s), bits = s->plan.word_bits;
    GSCL_TRY(gscl_codebook_create(&s->codebook, &s->fit, t->position_bits, bits, bits));
    gscl_stage(s->encoder->context, GSCL_STAGE_FIT_CODEBOOKS);
    for (int step = first; step < s->plan.steps; step++) {
        if ((step - first) % t->cluster_interval == 0)
            GSCL_TRY(cluster_and_sort(s, step > first));
        GSCL_TRY(gscl_codebook_step_straight_through(&s->codebook, (float)rate_at((double)step / s->plan.steps)));
    }
    return cluster_and_sort(s, s->plan.steps > first);
}
