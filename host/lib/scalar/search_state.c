#include "scalar/search_state.h"

#include <math.h>

#include "scalar/scalar_fit.h"

static const struct gscl_scalar_tunables *const tunables = &gscl_scalar_tunables;

static gscl_result measure_kept(gscl_scalar_state *s, gscl_kept_codes *kept) {
    GSCL_TRY(gscl_kept_codes_restore(kept, s));
    return kept->count > 0 ? gscl_scalar_measure(s, &kept->error) : GSCL_OK;
}

gscl_result gscl_search_keep_within(gscl_search *q, double error) {
    return gscl_scalar_is_within_budget(q->s) ? gscl_kept_codes_keep_better(&q->within, q->s, error) : GSCL_OK;
}

gscl_result gscl_search_set_level(gscl_search *q, int level) {
    gscl_scalar_state *s = q->s;
    const double pixels = (double)gscl_fit_level_pixels(&s->fit);
    GSCL_TRY(gscl_fit_set_level(&s->fit, s->source->first_level + level));
    q->lambda *= (double)gscl_fit_level_pixels(&s->fit) / pixels;
    GSCL_TRY(measure_kept(s, &q->within));
    return measure_kept(s, &q->best);
}

/* What a pass takes for the price: it multiplies error / (2 * bits of the file) by it. */
static double lambda_scale(const gscl_search *q, double error, double factor) {
    const double price = factor * q->lambda * 2 * 8 * (double)q->s->size;
    return fmin(fmax(error > 0 ? price / error : 0, tunables->min_lambda_scale), tunables->max_lambda_scale);
}

gscl_result gscl_search_pass(gscl_search *q, double error, double factor, bool scan_textures) {
    gscl_scalar_state *s = q->s;
    gscl_scalar_rdo_settings settings = gscl_scalar_rdo_default_settings(lambda_scale(q, error, factor));
    settings.scan_textures = scan_textures;
    if (q->elongation_is_free)
        settings.elongation_price = 0;
    GSCL_TRY(gscl_scalar_rdo_pass(&s->rdo, &s->fit, s->coded, &settings));
    return gscl_scalar_update_size(s);
}
