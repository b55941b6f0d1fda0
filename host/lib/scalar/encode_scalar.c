#include "scalar/encode_scalar.h"

#include "runtime/timing.h"
#include "scalar/byte_budget.h"
#include "scalar/choose_codes.h"
#include "scalar/scalar_fit.h"

/* The stages of the default profile. */
static gscl_result run_stages(gscl_scalar_state *s) {
    GSCL_TRY(gscl_scalar_fit(s));
    gscl_stage(s->encoder->context, GSCL_STAGE_QUANTISE);
    GSCL_TRY(gscl_scalar_quantise(s));
    if (s->has_choice) {
        GSCL_TRY(gscl_scalar_choose_codes(s));
        GSCL_TRY(gscl_scalar_meet_budget(s));
        gscl_scalar_drop_unused_effects(s);
    }
    return gscl_scalar_trim(s);
}

gscl_result gscl_encode_scalar(gscl_encoder *e, gscl_size_target target) {
    const gscl_scalar_plan plan = {
        .source = &e->source, .coded = &e->coded, .target = target, .preset = &gscl_effort_presets[e->settings.effort]};
    gscl_scalar_state state;
    gscl_scalar_begin(&state, e, &plan);
    const gscl_result result = run_stages(&state);
    gscl_scalar_end(&state);
    return result;
}
