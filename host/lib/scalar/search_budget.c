/* The part of the search that brings an image to the size of the budget. */
#include <math.h>

#include "scalar/choose_codes.h"
#include "scalar/scalar_fit.h"
#include "scalar/search_state.h"

static const struct gscl_scalar_tunables *const tunables = &gscl_scalar_tunables;

/* Keeps the coded image in q->within where its error is the lowest. */
static gscl_result keep_within_budget(gscl_search *q) {
    gscl_scalar_state *s = q->s;
    double error;
    if (s->size > s->bytes || s->coded->file.header.splat_count == 0)
        return GSCL_OK;
    GSCL_TRY(gscl_scalar_measure(s, &error));
    const bool better = q->within.count == 0 || error < q->within.error;
    return better ? gscl_kept_codes_keep(&q->within, s, error) : GSCL_OK;
}

gscl_result gscl_search_to_budget(gscl_search *q, const gscl_kept_codes *from, bool scan_textures) {
    gscl_scalar_state *s = q->s;
    double low = 0, high = INFINITY, factor = 1, step = tunables->search_price_step;
    for (int trial = 0; trial < tunables->search_trials; trial++) {
        GSCL_TRY(gscl_kept_codes_restore(from, s));
        s->coded->file.header.has_texture = s->textures;
        GSCL_TRY(gscl_search_pass(q, from->error, factor, scan_textures));
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

/* Tries to use the bytes that are left.  The image has them left because none of its splats' codes can be improved. */
static gscl_result use_bytes_left(gscl_search *q) {
    for (int trial = 0; trial < tunables->search_additions; trial++) {
        GSCL_TRY(continue_within_budget(q));
        if (q->within.count == 0 || q->within.size + 1 >= q->s->bytes || q->within.count >= q->s->max_splats)
            return GSCL_OK;
        q->elongation_is_free = trial > 0;
        GSCL_TRY(add_splats(q));
        GSCL_TRY(gscl_search_to_budget(q, &q->best, false));
    }
    return continue_within_budget(q);
}

/* Without waves, the file saves the bits that say so of each splat. */
static gscl_result decide_textures(gscl_search *q) {
    gscl_scalar_state *s = q->s;
    if (!s->textures || q->within.count == 0)
        return GSCL_OK;
    GSCL_TRY(gscl_kept_codes_restore(&q->within, s));
    gscl_scalar_drop_unused_effects(s);
    s->textures = s->coded->file.header.has_texture;
    GSCL_TRY(gscl_scalar_update_size(s));
    return gscl_kept_codes_keep(&q->within, s, q->within.error);
}

gscl_result gscl_search_meet_budget(gscl_search *q) {
    GSCL_TRY(continue_within_budget(q));
    GSCL_TRY(gscl_search_to_budget(q, &q->best, q->s->textures));
    GSCL_TRY(decide_textures(q));
    GSCL_TRY(continue_within_budget(q));
    GSCL_TRY(gscl_search_to_budget(q, &q->best, false));
    return use_bytes_left(q);
}
