#include "scalar/search.h"

#include <math.h>
#include <string.h>

#include "fit/random.h"
#include "host/system/clock.h"
#include "runtime/elementary.h"
#include "runtime/timing.h"
#include "scalar/scalar_fit.h"
#include "scalar/search_plan.h"
#include "scalar/search_state.h"
#include "session/encode_trace.h"

static const struct gscl_scalar_tunables *const tunables = &gscl_scalar_tunables;

/* A random whole number with this mean. */
static size_t random_count(gscl_scalar_state *s, double mean) {
    return (size_t)(mean + (double)gscl_random_unit(&s->random));
}

static void remove_splats(gscl_scalar_state *s, size_t count) {
    gsf_coded_image *file = &s->coded->file;
    for (; count > 0 && file->header.splat_count > 1; count--) {
        const uint32_t splats = file->header.splat_count;
        const uint32_t i = (uint32_t)((double)gscl_random_unit(&s->random) * splats);
        memmove(&file->splats[i], &file->splats[i + 1], (splats - 1 - i) * sizeof file->splats[0]);
        file->header.splat_count--;
    }
}

/* The mean number of splats by which a candidate should have more than the best image, which may be smaller than the
 * budget: the price alone would fill it by finer codes. */
static double missing_splats(const gscl_search *q) {
    const double bytes = fmax((double)q->s->bytes - (double)q->best.size, 0);
    return tunables->search_added * q->best.count + 8 * bytes / tunables->expected_bits_per_splat;
}

static bool has_valid_count(const gscl_scalar_state *s) {
    const uint32_t splats = s->coded->file.header.splat_count;
    return splats > 0 && splats <= s->max_splats;
}

/* Another image: a part of the best one comes from another result of the pool (with `combines`, where one promises a
 * gain), or some of its splats are removed; others are added, and all are fitted. */
static gscl_result make_candidate(gscl_search *q, bool combines) {
    gscl_scalar_state *s = q->s;
    bool is_combined = false;
    GSCL_TRY(gscl_kept_codes_restore(&q->best, s));
    if (combines)
        GSCL_TRY(gscl_search_pool_combine(q->pool, s, &is_combined));
    if (is_combined && !has_valid_count(s)) {
        GSCL_TRY(gscl_kept_codes_restore(&q->best, s));
        is_combined = false;
    }
    const size_t removed = is_combined ? 0 : random_count(s, tunables->search_removed * q->best.count);
    size_t added = random_count(s, missing_splats(q));
    remove_splats(s, removed);
    const size_t left = s->coded->file.header.splat_count;
    added += q->best.count > left ? q->best.count - left : 0;
    if (left + added > s->max_splats)
        added = s->max_splats > left ? s->max_splats - left : 0;
    GSCL_TRY(gscl_scalar_refit(s, added, tunables->search_steps));
    return gscl_scalar_update_size(s);
}

/* Passes over a candidate.  The price in a pass follows the size before it. */
static gscl_result choose_candidate_codes(gscl_search *q, double *error) {
    gscl_scalar_state *s = q->s;
    double factor = 1;
    GSCL_TRY(gscl_scalar_measure(s, error));
    for (int pass = 0; pass < tunables->search_passes && s->coded->file.header.splat_count > 0; pass++) {
        GSCL_TRY(gscl_search_pass(q, *error, factor, false));
        factor = (double)s->size / (double)s->bytes;
    }
    return gscl_scalar_measure(s, error);
}

/* The error that an image is expected to have at the size of the budget.  Far from it, the last codes gain less by the
 * bit than they do in the mean. */
static double scaled_error(const gscl_search *q, double error, size_t size) {
    const double excess = gscl_ln((double)size / (double)q->s->bytes);
    return error * gscl_exp(tunables->search_size_slope * excess + tunables->search_size_curvature * excess * excess);
}

/* The price of all later rounds follows the size, too: the candidates have the size of the budget in the mean.  Below
 * the lowest price of a pass it would have no effect any more. */
static void update_price(gscl_search *q) {
    const double bytes = (double)q->s->bytes;
    q->lambda *= gscl_pow((double)q->s->size / bytes, tunables->search_price_gain);
    q->lambda = fmax(q->lambda, tunables->min_lambda_scale * q->best.error / (2 * 8 * bytes));
}

static gscl_result search_round(gscl_search *q, bool combines) {
    gscl_scalar_state *s = q->s;
    double error;
    GSCL_TRY(make_candidate(q, combines));
    GSCL_TRY(choose_candidate_codes(q, &error));
    GSCL_TRY(gscl_search_keep_within(q, error));
    if (scaled_error(q, error, s->size) < scaled_error(q, q->best.error, q->best.size)) {
        GSCL_TRY(gscl_kept_codes_keep(&q->best, s, error));
        GSCL_TRY(gscl_trace_coded_image(s->encoder, &s->fit, s->coded, s->steps));
    }
    update_price(q);
    return GSCL_OK;
}

static gscl_result report_round(const gscl_search *q, int round) {
    const gscl_scalar_state *s = q->s;
    gscl_progress_state *progress = &s->encoder->progress;
    const int rounds = s->rounds + (s->ends_search ? s->combinations + 1 : 0); /* the end takes the time of some */
    const double share = (round + 1.0) / rounds;
    progress->splats = q->best.count;
    gscl_log(s->encoder->context, GSCL_LOG_DEBUG, "%.2f s, round %d: %u splats, %zu bytes; best %u splats, %zu bytes",
             gscl_now() - progress->start_s, round + 1, s->coded->file.header.splat_count, s->size, q->best.count,
             q->best.size);
    return gscl_progress_report(s->encoder->context, progress, s->passes_end + (1 - s->passes_end) * share);
}

/* The best image of the pool becomes the one that is changed. */
static gscl_result take_best_of_pool(gscl_search *q) {
    const gscl_search_pool *pool = q->pool;
    const gscl_kept_codes *best = &pool->members[0].codes;
    for (size_t i = 1; i < pool->count; i++) {
        const gscl_kept_codes *codes = &pool->members[i].codes;
        if (scaled_error(q, codes->error, codes->size) < scaled_error(q, best->error, best->size))
            best = codes;
    }
    GSCL_TRY(gscl_kept_codes_restore(best, q->s));
    return gscl_kept_codes_keep(&q->best, q->s, best->error);
}

static gscl_result add_best_to_pool(gscl_search *q) {
    GSCL_TRY(gscl_kept_codes_restore(&q->best, q->s));
    return gscl_search_pool_add(q->pool, q->s, q->best.error);
}

/* The rounds of one start, whose result the pool keeps. */
static gscl_result explore(gscl_search *q) {
    gscl_scalar_state *s = q->s;
    double error;
    GSCL_TRY(gscl_scalar_measure(s, &error));
    GSCL_TRY(gscl_kept_codes_keep(&q->best, s, error));
    GSCL_TRY(gscl_search_keep_within(q, error));
    q->lambda = tunables->search_first_price * error / (2 * 8 * (double)s->bytes);
    for (int round = 0; round < s->rounds; round++) {
        GSCL_TRY(search_round(q, false));
        GSCL_TRY(report_round(q, round));
    }
    return add_best_to_pool(q);
}

/* The rounds after the last start of a search: every second one combines. */
static gscl_result combine(gscl_search *q) {
    gscl_scalar_state *s = q->s;
    GSCL_TRY(take_best_of_pool(q));
    for (int round = 0; round < s->combinations; round++) {
        GSCL_TRY(search_round(q, round % 2 == 0));
        GSCL_TRY(report_round(q, s->rounds + round));
    }
    GSCL_TRY(add_best_to_pool(q));
    GSCL_TRY(gscl_search_to_budget(q, &q->best));
    return gscl_search_meet_budget(q);
}

static gscl_result run_search(gscl_search *q) {
    gscl_scalar_state *s = q->s;
    GSCL_TRY(gscl_fit_set_level(&s->fit, s->source->first_level + s->finest));
    GSCL_TRY(explore(q));
    if (s->ends_search)
        GSCL_TRY(combine(q));
    GSCL_TRY(gscl_fit_set_level(&s->fit, s->source->first_level));
    return gscl_kept_codes_restore(&q->best, s);
}

gscl_result gscl_scalar_search(gscl_scalar_state *s, gscl_search_pool *pool) {
    gscl_search q = {.s = s, .pool = pool, .within = pool->within};
    if (!s->is_searched || s->coded->file.header.splat_count == 0)
        return GSCL_OK;
    const gscl_result result = run_search(&q);
    gscl_kept_codes_free(&q.best);
    pool->within = q.within;
    if (s->ends_search)
        gscl_kept_codes_free(&pool->within);
    return result;
}
