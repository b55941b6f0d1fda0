/* The part of the search that brings an image to the size of the budget. */
#include <math.h>

#include "scalar/choose_codes.h"
#include "scalar/scalar_fit.h"
#include "scalar/search_plan.h"
#include "scalar/search_state.h"

static const struct gscl_scalar_tunables *const tunables = &gscl_scalar_tunables;

/* Measures the coded image where it fits, and keeps it in q->within where its error is the lowest. */
static gscl_result keep_within_budget(gscl_search *q) {
    gscl_scalar_state *s = q->s;
    double error;
    if (s->size > s->bytes || s->coded->file.header.splat_count == 0)
        return GSCL_OK;
    GSCL_TRY(gscl_scalar_measure(s, &error));
    return gscl_search_keep_within(q, error);
}

gscl_result gscl_search_to_budget(gscl_search *q, const gscl_kept_codes *from) {
    gscl_scalar_state *s = q->s;
    double low = 0, high = INFINITY, factor = 1, step = tunables->search_price_step;
    for (int trial = 0; trial < tunables->search_trials; trial++) {
        GSCL_TRY(gscl_kept_codes_restore(from, s));
        s->coded->file.header.has_texture = s->textures;
        GSCL_TRY(gscl_search_pass(q, from->error, factor, false));
        GSCL_TRY(keep_within_budget(q));
        *(s->size > s->bytes ? &low : &high) = factor;
        factor = low == 0 ? high / step : high == INFINITY ? low * step : sqrt(low * high);
        step *= step; /* used again only while one of the bounds is open */
    }
    return GSCL_OK;
}

/* Replaces q->best, whose role is over, by q->within. */
static gscl_result continue_within_budget(gscl_search *q) {
    if (q->within.count == 0)
        return GSCL_OK; /* nothing is: the stage after the search drops splats */
    GSCL_TRY(gscl_kept_codes_restore(&q->within, q->s));
    return gscl_kept_codes_keep(&q->best, q->s, q->within.error);
}

/* Adds the splats that the bytes left may hold, at least one, and fits all. */
static gscl_result add_splats(gscl_search *q) {
    gscl_scalar_state *s = q->s;
    double error;
    const double bits = 8 * (double)(s->bytes - q->best.size);
    GSCL_TRY(gscl_kept_codes_restore(&q->best, s));
    GSCL_TRY(gscl_scalar_refit(s, (size_t)(bits / tunables->expected_bits_per_splat) + 1, tunables->search_steps));
    s->coded->file.header.has_texture = s->textures;
    GSCL_TRY(gscl_scalar_update_size(s));
    GSCL_TRY(gscl_scalar_measure(s, &error));
    return gscl_kept_codes_keep(&q->best, s, error);
}

static bool is_full(const gscl_search *q) {
    return q->within.count == 0 || q->within.size + 1 >= q->s->bytes;
}

/* Tries to use the bytes that are left: by codes alone, where elongation may be free, then by more splats. */
static gscl_result use_bytes_left(gscl_search *q) {
    for (int trial = 0; trial <= tunables->search_additions; trial++) {
        GSCL_TRY(continue_within_budget(q));
        if (is_full(q) || (trial > 0 && q->within.count >= q->s->max_splats))
            return GSCL_OK;
        q->elongation_is_free = trial != 1;
        if (trial > 0)
            GSCL_TRY(add_splats(q));
        GSCL_TRY(gscl_search_to_budget(q, &q->best));
    }
    return continue_within_budget(q);
}

/* Gives waves to the splats of q->best for which they pay.  Where none does, the file saves the bits that say so of each
 * splat. */
static gscl_result add_waves(gscl_search *q) {
    gscl_scalar_state *s = q->s;
    double error;
    GSCL_TRY(gscl_kept_codes_restore(&q->best, s));
    s->coded->file.header.has_texture = true;
    GSCL_TRY(gscl_search_pass(q, q->best.error, 1, true));
    s->textures = gscl_scalar_count_textured(&s->coded->file) > 0;
    if (!s->textures)
        return gscl_kept_codes_restore(&q->best, s);
    GSCL_TRY(gscl_scalar_measure(s, &error));
    return gscl_kept_codes_keep(&q->best, s, error);
}

static gscl_result set_final_level(gscl_search *q, bool waves) {
    const gscl_scalar_state *s = q->s;
    return gscl_search_set_level(q, gscl_search_final_level(s->source_pixels, s->finest, waves));
}

gscl_result gscl_search_meet_budget(gscl_search *q) {
    gscl_scalar_state *s = q->s;
    GSCL_TRY(set_final_level(q, s->waves_at_end));
    GSCL_TRY(continue_within_budget(q));
    if (s->waves_at_end)
        GSCL_TRY(add_waves(q));
    if (s->waves_at_end && !s->textures)
        GSCL_TRY(set_final_level(q, false)); /* which takes less time */
    GSCL_TRY(gscl_search_to_budget(q, &q->best));
    return use_bytes_left(q);
}
