/* Probe fits: short fits by which effects are decided. */
#include "scalar/byte_budget.h"
#include "scalar/choose_codes.h"
#include "scalar/encode_scalar.h"
#include "scalar/scalar_fit.h"

/* The coarsest level with all detail that the target number of splats can represent. */
static int probe_level(const gscl_scalar_state *s) {
    const double distance = gscl_scalar_tunables.probe_distance;
    double pixels = s->source_pixels;
    int level = 0;
    while (pixels > gscl_scalar_tunables.small_image_pixels && pixels / (double)(s->target + 1) > distance * distance) {
        pixels /= 4;
        level++;
    }
    return level;
}

/* Runs rate-distortion passes down to the budget and loads the coded splats into the fit.  Without the passes a probe
 * fit can mislead: on small objects of one kind circles lose before the passes and win by 1 dB after them. */
static gscl_result probe_codes(gscl_scalar_state *s) {
    if (!s->has_choice)
        return GSCL_OK;
    s->textures = false;
    GSCL_TRY(gscl_scalar_quantise(s));
    GSCL_TRY(gscl_scalar_choose_codes(s));
    GSCL_TRY(gscl_scalar_meet_budget(s));
    return gscl_scalar_load(s);
}

/* Squared error per sample of the fit at its level, drawn through its quantiser. */
static gscl_result mean_error(gscl_fit *fit, double *mse) {
    double sum;
    GSCL_TRY(gscl_fit_rendering_error(fit, &sum));
    *mse = sum / ((double)gscl_fit_level_pixels(fit) * fit->renderer.channels);
    return GSCL_OK;
}

gscl_result gscl_scalar_probe_fit(gscl_encoder *e, const gscl_source *source, const gsf_header *header,
                                  gscl_size_target target, double *mse) {
    gscl_coded_image coded = {.file = {.header = *header, .bare = true}};
    const gscl_scalar_plan plan = {
        .source = source, .coded = &coded, .target = target, .preset = &gscl_probe_preset, .all = target};
    gscl_scalar_state state;
    gscl_scalar_begin(&state, e, &plan, 0);
    state.finest = probe_level(&state);
    gscl_result result = gscl_scalar_fit(&state);
    if (result == GSCL_OK)
        result = probe_codes(&state);
    if (result == GSCL_OK)
        result = mean_error(&state.fit, mse);
    gscl_scalar_end(&state);
    gscl_coded_image_free(&coded);
    return result;
}
