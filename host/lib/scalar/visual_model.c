#include "scalar/visual_model.h"

#include <math.h>

static const struct gscl_scalar_tunables *const tunables = &gscl_scalar_tunables;

/* Steps since the first one with the visual loss, which may be to come. */
static int steps_with_model(const gscl_scalar_state *s, int step) {
    return step - (int)(tunables->model_from * s->steps);
}

static bool is_due(const gscl_scalar_state *s, int after) {
    return after >= 0 && (s->fit.model_level != s->fit.level || after % tunables->model_interval == 0);
}

/* The visual loss of the last model, as the sum of errors whose share is 1. */
static gscl_result read_loss(gscl_scalar_state *s, double *loss) {
    const double pixels = (double)gscl_fit_level_pixels(&s->fit);
    GSCL_TRY(gscl_visual_read_loss(&s->fit.visual, s->encoder->context, loss));
    *loss *= 2000 / (pixels * (double)s->fit.visual_share);
    return GSCL_OK;
}

/* Whether little is seen of the error.  The sum of errors falls during the fit, and is judged once, before it has an effect;
 * single points of light keep it high where the error is small. */
static gscl_result judge_loss(gscl_scalar_state *s, bool is_first, bool *sees_little) {
    double loss = INFINITY;
    GSCL_TRY(gscl_scalar_measure_rendering(s));
    if (is_first)
        GSCL_TRY(read_loss(s, &loss));
    *sees_little = loss < tunables->min_visual_loss || s->known_error < tunables->min_visual_error;
    if (is_first || *sees_little)
        gscl_log(s->encoder->context, GSCL_LOG_DEBUG, "visual loss %.2f, squared error %.3g%s", loss, s->known_error,
                 *sees_little ? ": squared error alone from now on" : "");
    return GSCL_OK;
}

gscl_result gscl_scalar_renew_model(gscl_scalar_state *s, int step) {
    const int after = steps_with_model(s, step);
    bool ends;
    if (!gscl_fit_has_visual_loss(&s->fit) || !is_due(s, after))
        return GSCL_OK;
    GSCL_TRY(gscl_fit_renew_model(&s->fit));
    if (after % (tunables->model_interval * tunables->models_to_check) != 0)
        return GSCL_OK;
    GSCL_TRY(judge_loss(s, after == 0, &ends));
    return ends ? gscl_fit_end_visual_loss(&s->fit) : GSCL_OK;
}
