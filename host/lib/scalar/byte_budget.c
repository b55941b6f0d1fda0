#include "scalar/byte_budget.h"

#include <math.h>
#include <string.h>

#include "runtime/elementary.h"
#include "scalar/choose_codes.h"
#include "scalar/kept_codes.h"
#include "scalar/scalar_fit.h"

static const struct gscl_scalar_tunables *const tunables = &gscl_scalar_tunables;

static bool has_slack(const gscl_scalar_state *s, double share) {
    return (double)s->size < share * (double)s->bytes;
}

/* Bytes, in the middle of the sizes of a full file. */
static double aimed_size(const gscl_scalar_state *s) {
    return (1 + s->full_share) / 2 * (double)s->bytes;
}

/* Lowers the price so far that a pass is expected to use the bytes that are left. */
static void lower_price(gscl_scalar_state *s) {
    const double aim = aimed_size(s);
    const double factor = fmax(gscl_pow((double)s->size / aim, tunables->refund_gain), tunables->slack_factor);
    s->lambda_scale = fmax(s->lambda_scale * factor, tunables->min_lambda_scale);
}

/* Keeps the codes in `best` where they fit and have a lower error.  *error: of the codes; INFINITY where they do not fit. */
static gscl_result keep_better(gscl_scalar_state *s, gscl_kept_codes *best, double *error) {
    *error = INFINITY;
    if (!gscl_scalar_is_within_budget(s))
        return GSCL_OK;
    GSCL_TRY(gscl_scalar_measure(s, error));
    return gscl_kept_codes_keep_better(best, s, *error);
}

/* Spends bytes that are left on finer codes and more textures. */
static gscl_result spend_on_codes(gscl_scalar_state *s) {
    lower_price(s);
    return gscl_scalar_pass(s, s->textures);
}

/* Adds splats for the bytes that are left, unless *may_add says that the fit did not stand it before, or that codes are to
 * have them. */
static gscl_result spend(gscl_scalar_state *s, bool *may_add) {
    if (!*may_add || gscl_scalar_has_max_splats(s) || !has_slack(s, tunables->densify_below))
        return spend_on_codes(s);
    s->lambda_scale = fmin(s->lambda_scale, 1);
    s->surplus = 1;
    /* New splats are far from their best after a single pass, and here none follow. */
    return gscl_scalar_densify(s, 2, s->textures, may_add);
}

/* Passes that use bytes that are left, for splats only if it may.  *error: of the codes after the last one. */
static gscl_result spend_in_passes(gscl_scalar_state *s, bool may_add, gscl_kept_codes *best, double *error) {
    for (int pass = 0; pass < tunables->max_slack_passes && has_slack(s, s->full_share); pass++) {
        GSCL_TRY(spend(s, &may_add));
        GSCL_TRY(keep_better(s, best, error));
    }
    return GSCL_OK;
}

/* Uses bytes that are left.  Where the last of them is worse than the best so far, as new splats may make it that
 * no steps are left for, the best gets finer codes instead. */
static gscl_result spend_slack(gscl_scalar_state *s, gscl_kept_codes *best) {
    double error;
    GSCL_TRY(keep_better(s, best, &error));
    GSCL_TRY(spend_in_passes(s, true, best, &error));
    if (s->size > s->bytes || best->count == 0 || error <= best->error)
        return GSCL_OK;
    GSCL_TRY(gscl_kept_codes_restore(best, s));
    return spend_in_passes(s, false, best, &error);
}

/* Uses bytes that are left: a few for finer codes and more textures, many for more splats, as long as the fit stands it.
 * `best`: of the files within the budget on the way, or empty where no bytes are left. */
static gscl_result use_slack(gscl_scalar_state *s, gscl_kept_codes *best) {
    if (!has_slack(s, s->full_share))
        return GSCL_OK;
    s->keep_all = true; /* new splats would be the first to be dropped */
    const gscl_result result = spend_slack(s, best);
    s->keep_all = false;
    return result;
}

/* The search for the price at which a pass ends below the budget and fills it. */
typedef struct price_search {
    gscl_kept_codes above; /* the file that is too large, from which passes start */
    gscl_kept_codes below; /* the largest file within the budget; empty: none was */
    double low, high;      /* lambda scales that left `above` too large, and made it smaller than a full one; 0: none */
    double low_size, high_size; /* bytes */
    double higher, higher_size; /* those of the price before `high` on its side of the budget; 0: none */
    bool was_above;             /* the file of the last price */
    double kept; /* weight of the side of the budget whose price stays: halved while the other is met again */
} price_search;

/* Notes what a pass at this price made of the file above.  Before one makes it too small, each is a step towards the budget. */
static gscl_result note_size(price_search *p, gscl_scalar_state *s, double lambda_scale) {
    const bool is_above = s->size > s->bytes;
    if (is_above && p->high == 0)
        return gscl_kept_codes_keep(&p->above, s, NAN);
    if (!is_above) {
        p->higher = p->high;
        p->higher_size = p->high_size;
    }
    p->kept = p->low > 0 && is_above == p->was_above ? p->kept / 2 : 1;
    p->was_above = is_above;
    *(is_above ? &p->low : &p->high) = lambda_scale;
    *(is_above ? &p->low_size : &p->high_size) = (double)s->size;
    return !is_above && p->below.size < s->size ? gscl_kept_codes_keep(&p->below, s, NAN) : GSCL_OK;
}

/* The price after one at which a pass made the file too small: where a straight line through the sizes at two prices meets `aim`,
 * those on the two sides of the budget or, before one made it too large, the last two.  A side whose price has not changed counts
 * half each time (the Illinois method): else the other would come closer in ever smaller steps. */
static double next_price(const price_search *p, double aim) {
    if (p->low > 0) {
        const double above = (p->low_size - aim) * (p->was_above ? 1 : p->kept);
        const double below = (aim - p->high_size) * (p->was_above ? p->kept : 1);
        return p->low * gscl_pow(p->high / p->low, above / (above + below));
    }
    if (p->higher > 0 && p->high_size > p->higher_size) {
        const double steps = (aim - p->high_size) / (p->high_size - p->higher_size);
        return p->high * fmax(gscl_pow(p->high / p->higher, steps), tunables->slack_factor);
    }
    return p->high * gscl_pow(p->high_size / aim, tunables->refund_gain);
}

static gscl_result try_price(price_search *p, gscl_scalar_state *s) {
    const size_t before = s->size;
    const double lambda_scale = s->lambda_scale, aim = aimed_size(s);
    GSCL_TRY(gscl_scalar_pass(s, false));
    GSCL_TRY(note_size(p, s, lambda_scale));
    if (p->high == 0) {
        gscl_scalar_update_lambda(s, before, aim, s->final_gain);
        return GSCL_OK;
    }
    s->lambda_scale = next_price(p, aim);
    return GSCL_OK;
}

static gscl_result search_price(price_search *p, gscl_scalar_state *s) {
    bool is_done = s->size <= s->bytes;
    if (!is_done)
        GSCL_TRY(gscl_kept_codes_keep(&p->above, s, NAN));
    for (int pass = 0; pass < tunables->max_final_passes && !is_done; pass++) {
        GSCL_TRY(try_price(p, s));
        is_done = s->size <= s->bytes && !has_slack(s, s->full_share);
        if (!is_done && p->high > 0)
            GSCL_TRY(gscl_kept_codes_restore(&p->above, s));
    }
    return s->size > s->bytes && p->below.count > 0 ? gscl_kept_codes_restore(&p->below, s) : GSCL_OK;
}

static gscl_result shrink_to_budget(gscl_scalar_state *s) {
    price_search search = {0};
    const gscl_result result = search_price(&search, s);
    gscl_kept_codes_free(&search.above);
    gscl_kept_codes_free(&search.below);
    return result;
}

/* Uses bytes that are left, shrinks the file to the budget at this price or a higher one, and prefers the best file on the
 * way. */
static gscl_result fill_budget(gscl_scalar_state *s, double lambda_scale, gscl_kept_codes *best) {
    double error;
    GSCL_TRY(use_slack(s, best));
    s->lambda_scale = fmax(s->lambda_scale, lambda_scale);
    GSCL_TRY(shrink_to_budget(s));
    if (best->count == 0)
        return GSCL_OK;
    GSCL_TRY(gscl_scalar_trim(s)); /* so that a file that is a little too large is compared, too */
    GSCL_TRY(keep_better(s, best, &error));
    return gscl_kept_codes_restore(best, s);
}

static gscl_result meet_budget_from(gscl_scalar_state *s, double lambda_scale) {
    gscl_kept_codes best = {0};
    const gscl_result result = fill_budget(s, lambda_scale, &best);
    gscl_kept_codes_free(&best);
    return result;
}

gscl_result gscl_scalar_meet_budget(gscl_scalar_state *s) {
    return s->bytes > 0 ? meet_budget_from(s, 0) : GSCL_OK;
}

/* Fits the splats that are left, keeps all of them in a pass for their codes, and meets the budget at the price from
 * before. */
static gscl_result refit_to_budget(gscl_scalar_state *s) {
    const double lambda_scale = s->lambda_scale;
    GSCL_TRY(gscl_scalar_refit(s, 0, tunables->steps_after_drops));
    s->keep_all = true;
    GSCL_TRY(gscl_scalar_pass(s, false));
    s->keep_all = false;
    return meet_budget_from(s, lambda_scale);
}

/* *is_better: whether the result stays, instead of the file before. */
static gscl_result try_refit(gscl_scalar_state *s, gscl_kept_codes *before, bool *is_better) {
    double error;
    GSCL_TRY(gscl_scalar_measure(s, &error));
    GSCL_TRY(gscl_kept_codes_keep(before, s, error));
    GSCL_TRY(refit_to_budget(s));
    GSCL_TRY(gscl_scalar_measure(s, &error));
    *is_better = s->size <= s->bytes && (error < before->error || before->size > s->bytes);
    return *is_better ? GSCL_OK : gscl_kept_codes_restore(before, s);
}

gscl_result gscl_scalar_refit_after_drops(gscl_scalar_state *s) {
    gscl_kept_codes before = {0};
    bool is_better = s->bytes > 0 && s->highest_lambda_scale >= tunables->refit_lambda_scale;
    gscl_result result = GSCL_OK;
    for (int i = 0; i < tunables->max_refits && is_better && result == GSCL_OK; i++)
        result = try_refit(s, &before, &is_better);
    gscl_kept_codes_free(&before);
    return result;
}

static void drop_smallest(gsf_coded_image *file, size_t fixed) {
    size_t smallest = fixed, count = file->header.splat_count;
    for (size_t i = fixed + 1; i < count; i++)
        if (2 * file->splats[i].major - file->splats[i].aspect <
            2 * file->splats[smallest].major - file->splats[smallest].aspect)
            smallest = i;
    memmove(&file->splats[smallest], &file->splats[smallest + 1], (count - 1 - smallest) * sizeof file->splats[0]);
    file->header.splat_count--;
}

gscl_result gscl_scalar_trim(gscl_scalar_state *s) {
    gsf_coded_image *file = &s->coded->file;
    if (s->bytes == 0)
        return GSCL_OK;
    GSCL_TRY(gscl_scalar_update_size(s));
    while (s->size > s->bytes && file->header.splat_count > s->fixed_count) {
        for (size_t excess = (s->size - s->bytes) / 5 + 1; excess > 0 && file->header.splat_count > s->fixed_count;
             excess--)
            drop_smallest(file, s->fixed_count);
        GSCL_TRY(gscl_file_size(s->encoder->context, s->coded, &s->size));
    }
    return GSCL_OK;
}
