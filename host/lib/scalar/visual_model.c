#include "scalar/visual_model.h"

static const struct gscl_scalar_tunables *const tunables = &gscl_scalar_tunables;

/* Steps since the first one with the visual loss, which may be to come. */
static int steps_with_model(const gscl_scalar_state *s, int step) {
    return step - (int)(tunables->model_from * s->steps);
}

int gscl_scalar_model_interval(const gscl_scalar_state *s) {
    return gscl_scalar_is_launch_bound(s) ? tunables->launch_bound_model_interval : tunables->model_interval;
}

static int models_to_check(const gscl_scalar_state *s) {
    return gscl_scalar_is_launch_bound(s) ? tunables->launch_bound_models_to_check : tunables->models_to_check;
}

static bool is_due(const gscl_scalar_state *s, int after) {
    return after >= 0 && (s->fit.model_level != s->fit.level || after % gscl_scalar_model_interval(s) == 0);
}

gscl_result gscl_scalar_renew_model(gscl_scalar_state *s, int step) {
    const int after = steps_with_model(s, step);
    if (!gscl_fit_has_visual_loss(&s->fit) || !is_due(s, after))
        return GSCL_OK;
    GSCL_TRY(gscl_fit_renew_model(&s->fit));
    if (after % (gscl_scalar_model_interval(s) * models_to_check(s)) != 0)
        return GSCL_OK;
    GSCL_TRY(gscl_scalar_measure_rendering(s));
    return s->known_error < tunables->min_visual_error ? gscl_fit_end_visual_loss(&s->fit) : GSCL_OK;
}
