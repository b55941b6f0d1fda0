#include "scalar/choose_codes.h"

#include <math.h>

#include "host/system/clock.h"
#include "runtime/elementary.h"
#include "runtime/timing.h"
#include "scalar/kept_codes.h"
#include "scalar/scalar_fit.h"
#include "scalar/scalar_progress.h"
#include "scalar/scalar_rdo.h"
#include "session/encode_trace.h"

static const struct gscl_scalar_tunables *const tunables = &gscl_scalar_tunables;

gscl_result gscl_scalar_pass(gscl_scalar_state *s, bool scan_textures) {
    gscl_scalar_rdo_settings settings = gscl_scalar_rdo_default_settings(s->lambda_scale);
    settings.keep_all = s->keep_all;
    settings.scan_textures = scan_textures;
    gscl_encoder *e = s->encoder;
    s->highest_lambda_scale = fmax(s->highest_lambda_scale, s->lambda_scale);
    GSCL_TRY(gscl_scalar_rdo_pass(&s->rdo, &s->fit, s->coded, &settings));
    GSCL_TRY(gscl_scalar_update_size(s));
    gscl_log(e->context, GSCL_LOG_DEBUG, "%.2f s, pass: %u splats, %zu bytes, lambda scale %.2f%s",
             gscl_now() - e->progress.start_s, s->coded->file.header.splat_count, s->size, s->lambda_scale,
             scan_textures ? ", scan" : "");
    GSCL_TRY(gscl_trace_coded_image(e, &s->fit, s->coded, s->steps));
    return gscl_scalar_report_pass(s, scan_textures);
}

bool gscl_scalar_has_max_splats(const gscl_scalar_state *s) {
    return s->is_given || s->coded->file.header.splat_count >= s->max_splats;
}

/* Adds splats for the bytes that are left, and fits all splats for some steps. */
static gscl_result add_splats(gscl_scalar_state *s) {
    const size_t count = s->coded->file.header.splat_count;
    size_t new_count = (size_t)(s->surplus * (double)s->bytes / (double)s->size * (double)count) + 1;
    new_count = new_count > s->max_splats ? s->max_splats : new_count;
    const int steps = s->steps / tunables->densify_steps_divisor + 1;
    return gscl_scalar_refit(s, new_count > count ? new_count - count : 0,
                             steps < tunables->max_densify_steps ? steps : tunables->max_densify_steps);
}

static gscl_result densify_from(gscl_scalar_state *s, int passes, bool scan_textures, gscl_kept_codes *before,
                                bool *is_kept) {
    double error;
    GSCL_TRY(gscl_scalar_measure(s, &error));
    GSCL_TRY(gscl_kept_codes_keep(before, s, error));
    GSCL_TRY(add_splats(s));
    for (int pass = 0; pass < passes; pass++)
        GSCL_TRY(gscl_scalar_pass(s, scan_textures && pass == 0));
    GSCL_TRY(gscl_scalar_measure(s, &error));
    *is_kept = error <= tunables->max_densify_growth * before->error;
    return *is_kept ? GSCL_OK : gscl_kept_codes_restore(before, s);
}

gscl_result gscl_scalar_densify(gscl_scalar_state *s, int passes, bool scan_textures, bool *is_kept) {
    gscl_kept_codes before = {0};
    const gscl_result result = densify_from(s, passes, scan_textures, &before, is_kept);
    gscl_kept_codes_free(&before);
    return result;
}

void gscl_scalar_update_lambda(gscl_scalar_state *s, size_t size_before, double target_size, double gain) {
    /* At this lambda the file would go on shrinking: the target is compared with the size after the next pass. */
    const double before = (double)size_before, size = (double)s->size;
    const double next = size < before ? size * size / before : size;
    s->lambda_scale = fmin(fmax(s->lambda_scale * gscl_pow(next / target_size, gain), tunables->min_lambda_scale),
                           tunables->max_lambda_scale);
}

/* Whether the budget has room for more splats than there are. */
static bool has_room(const gscl_scalar_state *s) {
    return s->bytes > 0 && !gscl_scalar_has_max_splats(s) &&
           (double)s->size < tunables->densify_below * (double)s->bytes;
}

/* The first pass, without textures.  Splats are added as long as the budget has room for more, and the fit stands it. */
static gscl_result pass_without_textures(gscl_scalar_state *s) {
    bool is_kept = true;
    GSCL_TRY(gscl_scalar_pass(s, false));
    for (int i = 0; i < tunables->max_densifications && has_room(s) && is_kept; i++)
        GSCL_TRY(gscl_scalar_densify(s, 1, false, &is_kept));
    return GSCL_OK;
}

uint32_t gscl_scalar_count_textured(const gsf_coded_image *file) {
    uint32_t textured = 0;
    for (uint32_t i = 0; i < file->header.splat_count; i++)
        textured += file->splats[i].texture.amplitude > 0;
    return textured;
}

static bool may_drop_textures(const gscl_scalar_state *s) {
    return gscl_effect_is_open(&s->encoder->effects, GSCL_EFFECT_TEXTURE);
}

/* After the first scan: where hardly any splat has a wave, the following passes do not scan. */
static void drop_rare_textures(gscl_scalar_state *s) {
    const gsf_coded_image *file = &s->coded->file;
    if (may_drop_textures(s) &&
        gscl_scalar_count_textured(file) < tunables->min_textured_share * file->header.splat_count)
        s->textures = false;
}

/* Passes that reduce the file slowly towards its budget, because splats that are dropped too early do not come back. */
static gscl_result pass_towards_budget(gscl_scalar_state *s) {
    const double budget = (double)s->bytes * tunables->budget_aim;
    double excess = 0;
    for (int pass = 0; pass < s->passes; pass++) {
        const size_t before = s->size;
        const double left = 1 - (pass + 2.0) / s->passes;
        GSCL_TRY(gscl_scalar_pass(s, s->textures && pass % tunables->scan_interval == 0));
        if (pass == 0)
            drop_rare_textures(s);
        if (s->bytes == 0)
            continue;
        if (pass == 0)
            excess = fmax((double)s->size - budget, 0);
        gscl_scalar_update_lambda(s, before, budget + excess * gscl_pow(fmax(left, 0), tunables->excess_exponent),
                                  tunables->lambda_gain);
    }
    return GSCL_OK;
}

gscl_result gscl_scalar_choose_codes(gscl_scalar_state *s) {
    /* A fit that did not need its finest level has no detail that a wave could represent. */
    if (may_drop_textures(s) && s->fit.level > s->source->first_level + s->finest)
        s->textures = false;
    GSCL_TRY(pass_without_textures(s));
    s->coded->file.header.has_texture = s->textures;
    return pass_towards_budget(s);
}

void gscl_scalar_drop_unused_effects(gscl_scalar_state *s) {
    const bool textured = gscl_scalar_count_textured(&s->coded->file) > 0;
    s->coded->file.header.has_texture = textured;
    if (may_drop_textures(s))
        gscl_effect_note(&s->encoder->effects, GSCL_EFFECT_TEXTURE, GSCL_EFFECT_PASSES, textured, NAN);
}
