#include "scalar/search.h"

#include <math.h>
#include <string.h>

#include "fit/random.h"
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

/* Another image: some splats of the best one are replaced, and all are fitted. */
static gscl_result make_candidate(gscl_search *q) {
    gscl_scalar_state *s = q->s;
    GSCL_TRY(gscl_kept_codes_restore(&q->best, s));
    const size_t removed = random_count(s, tunables->search_removed * q->best.count);
    size_t added = removed + random_count(s, missing_splats(q));
    remove_splats(s, removed);
    const size_t left = s->coded->file.header.splat_count;
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

static double cost(const gscl_search *q, double error, size_t size) {
    return error + q->lambda * 8 * (double)size;
}

/* The price of all later rounds follows the size, too: the candidates have the size of the budget in the mean.  Below
 * the lowest price of a pass it would have no effect any more. */
static void update_price(gscl_search *q) {
    const double bytes = (double)q->s->bytes;
    q->lambda *= pow((double)q->s->size / bytes, tunables->search_price_gain);
    q->lambda = fmax(q->lambda, tunables->min_lambda_scale * q->best.error / (2 * 8 * bytes));
}

static gscl_result search_round(gscl_search *q) {
    gscl_scalar_state *s = q->s;
    double error;
    GSCL_TRY(make_candidate(q));
    GSCL_TRY(choose_candidate_codes(q, &error));
    if (cost(q, error, s->size) < cost(q, q->best.error, q->best.size)) {
        GSCL_TRY(gscl_kept_codes_keep(&q->best, s, error));
        GSCL_TRY(gscl_trace_coded_image(s->encoder, &s->fit, s->coded, s->steps));
    }
    update_price(q);
    return GSCL_OK;
}

static gscl_result report_round(const gscl_search *q, int round) {
    const gscl_scalar_state *s = q->s;
    gscl_progress_state *progress = &s->encoder->progress;
    const double share = (round + 1.0) / (s->rounds + 1.0); /* the last part takes the time of some rounds */
    progress->splats = q->best.count;
    gscl_log(s->encoder->context, GSCL_LOG_DEBUG, "%.2f s, round %d: %u splats, %zu bytes; best %u splats, %zu bytes",
             gscl_now() - progress->start_s, round + 1, s->coded->file.header.splat_count, s->size, q->best.count,
             q->best.size);
    return gscl_progress_report(s->encoder->context, progress, s->passes_end + (1 - s->passes_end) * share);
}

/* Whether the search of this effort or a lower one ends after so many rounds of this start. */
static bool ends_an_effort(const gscl_scalar_state *s, int rounds) {
    if (s->start_index > 0)
        return rounds == s->rounds;
    for (int effort = 0; effort <= GSCL_MAX_EFFORT; effort++)
        if (rounds == gscl_search_rounds(s->source_pixels, s->finest, gscl_effort_presets[effort].rounds))
            return true;
    return false;
}

/* Keeps q->best as a result of the search where it is better than those before, by the pixels of the source. */
static gscl_result keep_result(gscl_search *q) {
    gscl_scalar_state *s = q->s;
    GSCL_TRY(gscl_search_set_level(q, 0));
    const bool fits = q->best.count > 0 && q->best.size <= s->bytes;
    const bool is_worse = q->ended.size <= s->bytes && q->best.error >= q->ended.error;
    if (q->ended.count > 0 && (!fits || is_worse))
        return GSCL_OK;
    GSCL_TRY(gscl_kept_codes_restore(&q->best, s));
    return gscl_kept_codes_keep(&q->ended, s, q->best.error);
}

/* The last part of an effort's search.  A higher effort ends all lower ones, too, and keeps the best result, so that it
 * is never worse. */
static gscl_result end_effort(gscl_search *q) {
    gscl_scalar_state *s = q->s;
    const double lambda = q->lambda;
    GSCL_TRY(gscl_kept_codes_restore(&q->best, s));
    GSCL_TRY(gscl_kept_codes_keep(&q->resumed, s, q->best.error));
    GSCL_TRY(gscl_search_to_budget(q, &q->best));
    GSCL_TRY(gscl_search_meet_budget(q));
    GSCL_TRY(keep_result(q));
    q->lambda = lambda;
    q->within.count = 0;
    q->elongation_is_free = false;
    s->textures = false;
    GSCL_TRY(gscl_kept_codes_restore(&q->resumed, s));
    GSCL_TRY(gscl_kept_codes_keep(&q->best, s, q->resumed.error));
    return gscl_fit_set_level(&s->fit, s->source->first_level + s->finest);
}

static gscl_result run_search(gscl_search *q) {
    gscl_scalar_state *s = q->s;
    double error;
    GSCL_TRY(gscl_fit_set_level(&s->fit, s->source->first_level + s->finest));
    GSCL_TRY(gscl_scalar_measure(s, &error));
    GSCL_TRY(gscl_kept_codes_keep(&q->best, s, error));
    q->lambda = tunables->search_first_price * error / (2 * 8 * (double)s->bytes);
    for (int round = 0; round < s->rounds; round++) {
        GSCL_TRY(search_round(q));
        if (ends_an_effort(s, round + 1))
            GSCL_TRY(end_effort(q));
        GSCL_TRY(report_round(q, round));
    }
    GSCL_TRY(gscl_fit_set_level(&s->fit, s->source->first_level));
    return gscl_kept_codes_restore(&q->ended, s);
}

gscl_result gscl_scalar_search(gscl_scalar_state *s) {
    gscl_search q = {.s = s};
    if (s->rounds == 0 || s->coded->file.header.splat_count == 0)
        return GSCL_OK;
    const gscl_result result = run_search(&q);
    gscl_kept_codes *const kept[] = {&q.best, &q.resumed, &q.ended, &q.within};
    for (size_t i = 0; i < sizeof kept / sizeof kept[0]; i++)
        gscl_kept_codes_free(kept[i]);
    return result;
}
