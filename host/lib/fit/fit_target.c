#include "cl/constants.h"
#include "fit/fit.h"
#include "fit/ssim_weights.h"
#include "fit/tunables.h"

const gscl_buffer *gscl_fit_weighted_target(const gscl_fit *f) {
    bool is_adapted = f->level == f->pyramid.first_level && f->adapted_target.memory;
    return is_adapted ? &f->adapted_target : &f->pyramid.levels[f->level];
}

gscl_result gscl_fit_render(gscl_fit *f) {
    GSCL_TRY(gscl_fit_set_rows(f, 1));
    GSCL_TRY(gscl_fit_bin(f, !f->has_known_lengths));
    return gscl_renderer_draw(&f->renderer);
}

gscl_result gscl_fit_adapt_target(gscl_fit *f) {
    const gscl_pyramid *p = &f->pyramid;
    if (f->renderer.options.weighted != GSCL_WEIGHTED_PIXELS || f->level != p->first_level ||
        p->first_level == p->last_level)
        return GSCL_OK;
    GSCL_TRY(gscl_fit_render(f));
    return gscl_weights_adapt(p, &f->ssim, &f->renderer.options, &f->renderer.image, &f->adapted_target);
}

bool gscl_fit_has_visual_loss(const gscl_fit *f) {
    return f->renderer.options.weighted == GSCL_WEIGHTED_LUMA && f->visual_share > 0;
}

gscl_result gscl_fit_renew_model_at(gscl_fit *f, const gscl_buffer *rendering, float curvature) {
    const gscl_visual_comparison comparison = {.pyramid = &f->pyramid,
                                               .options = &f->renderer.options,
                                               .level = f->level,
                                               .rendering = rendering,
                                               .share = f->visual_share};
    if (!gscl_fit_has_visual_loss(f))
        return GSCL_OK;
    GSCL_TRY(gscl_visual_model(&f->visual, &comparison, curvature, &f->pyramid.levels[f->level]));
    f->model_level = f->level;
    return GSCL_OK;
}

gscl_result gscl_fit_renew_model(gscl_fit *f) {
    if (!gscl_fit_has_visual_loss(f))
        return GSCL_OK;
    GSCL_TRY(gscl_fit_render(f));
    return gscl_fit_renew_model_at(f, &f->renderer.image, gscl_fit_tunables.curvature_of_steps);
}

gscl_result gscl_fit_end_visual_loss(gscl_fit *f) {
    const int level = f->model_level;
    f->visual_share = 0;
    if (level < 0)
        return GSCL_OK;
    const size_t plane = gscl_pyramid_pixels(&f->pyramid, level) * sizeof(float);
    f->model_level = -1;
    return gscl_buffer_zero(f->context, &f->pyramid.levels[level], (size_t)f->renderer.channels * plane,
                            GSCL_WEIGHTED_LUMA * plane);
}
