#include "encode/effect_search.h"

#include <math.h>

#include "encode/coherence.h"
#include "encode/prepare.h"
#include "encode/tunables.h"
#include "runtime/elementary.h"
#include "runtime/timing.h"
#include "scalar/encode_scalar.h"

/* Ellipses instead of circles. */
#define SHAPES (GSCL_EFFECT_ROTATION | GSCL_EFFECT_ANISOTROPY)

typedef struct effect_search {
    gscl_encoder *encoder;
    double psnr;        /* of a probe fit with the effects as they are decided so far; NAN: not measured yet */
    double missing_mse; /* squared error per sample that probe fits do not measure: of colours that grey lacks */
} effect_search;

/* PSNR of a probe fit of `source` without the effects `off`. */
static gscl_result probe_psnr(const effect_search *s, const gscl_source *source, uint32_t off, double missing_mse,
                              double *psnr) {
    gscl_encoder *e = s->encoder;
    gscl_effects effects = e->effects;
    gsf_header header = e->header;
    double mse = 0;
    effects.off |= off;
    /* Probe fits compare shapes more reliably without the opacity that isolated objects get (session/effects.c). */
    if (gscl_effect_is_open(&effects, GSCL_EFFECT_OPACITY) && !effects.alpha_blend)
        effects.off |= GSCL_EFFECT_OPACITY;
    gscl_effects_set_header(&effects, &source->background, &header);
    GSCL_TRY(gscl_scalar_probe_fit(e, source, &header, e->target, &mse));
    *psnr = -10 * gscl_log10(fmax(mse + missing_mse, 1e-12));
    return GSCL_OK;
}

/* Measures search->psnr unless it is known. */
static gscl_result measure_current_psnr(effect_search *s) {
    return isnan(s->psnr) ? probe_psnr(s, &s->encoder->source, 0, s->missing_mse, &s->psnr) : GSCL_OK;
}

/* Switches effects on or off and notes the trial as the reason. */
static void decide_by_trial(gscl_effects *effects, uint32_t mask, bool on, double gain_db) {
    *(on ? &effects->on : &effects->off) |= mask;
    for (uint32_t effect = 1; effect <= mask; effect <<= 1)
        if (mask & effect)
            gscl_effect_note(effects, (gscl_effect)effect, GSCL_EFFECT_TRIAL, on, gain_db);
}

/* ---- Grey instead of faint colours ---- */

/* Root mean square of the colours' differences from grey. */
static double colourfulness(const gscl_source *s) {
    const size_t pixels = s->pixels;
    double sum = 0;
    for (size_t i = 0; i < pixels; i++) {
        const double r = s->planes[i], g = s->planes[pixels + i], b = s->planes[2 * pixels + i], mean = (r + g + b) / 3;
        sum += (r - mean) * (r - mean) + (g - mean) * (g - mean) + (b - mean) * (b - mean);
    }
    return sqrt(sum / (3 * (double)pixels));
}

/* A probe fit of the image in grey.  Where it is no worse than the fit in colour, grey becomes the source. */
static gscl_result try_grey(effect_search *s, const gscl_image *image, double missing_mse, double *psnr) {
    gscl_encoder *e = s->encoder;
    gscl_source grey = {0};
    gsf_header header = e->header;
    header.has_chroma = false;
    gscl_result result = gscl_source_create(&grey, e->context, image, &header);
    if (result == GSCL_OK)
        result = probe_psnr(s, &grey, GSCL_EFFECT_CHROMA, missing_mse, psnr);
    if (result == GSCL_OK && *psnr >= s->psnr) {
        const gscl_source coloured = e->source;
        e->source = grey;
        s->missing_mse = missing_mse;
        grey = coloured;
    }
    gscl_source_free(&grey);
    return result;
}

/* With an alpha channel the errors of grey and colour are not comparable. */
static bool may_drop_chroma(const gscl_encoder *e) {
    return e->header.has_chroma && !e->header.has_alpha && gscl_effect_is_open(&e->effects, GSCL_EFFECT_CHROMA);
}

static gscl_result decide_chroma(effect_search *s, const gscl_image *image) {
    gscl_encoder *e = s->encoder;
    if (!may_drop_chroma(e))
        return GSCL_OK;
    const double colour = colourfulness(&e->source);
    gscl_log(e->context, GSCL_LOG_DEBUG, "colourfulness: %.4f", colour);
    if (colour > gscl_encode_tunables.max_probe_colour)
        return GSCL_OK;
    GSCL_TRY(measure_current_psnr(s));
    double grey = -20 * gscl_log10(fmax(colour, 1e-6)); /* upper bound: only the colours are wrong */
    if (s->psnr <= grey)
        GSCL_TRY(try_grey(s, image, colour * colour, &grey));
    decide_by_trial(&e->effects, GSCL_EFFECT_CHROMA, s->psnr > grey, s->psnr - grey);
    s->psnr = fmax(s->psnr, grey);
    return GSCL_OK;
}

/* ---- Circles instead of ellipses ---- */

/* Ellipses gain little where edges have no common direction within the reach of a splat. */
static gscl_result may_drop_shapes(const gscl_encoder *e, const gscl_image *image, bool *may_drop) {
    const gscl_size_target target = e->target;
    const double splats =
        target.bytes ? 8.0 * (double)target.bytes / gscl_encode_tunables.probe_bits : (double)target.splats;
    double coherence = 1;
    *may_drop = false;
    if ((e->effects.on | e->effects.off) & SHAPES)
        return GSCL_OK;
    GSCL_TRY(gscl_edge_coherence(e->context, image, e->source.first_level + gscl_encode_tunables.coherence_level,
                                 splats, &coherence));
    gscl_log(e->context, GSCL_LOG_DEBUG, "coherence of edges: %.2f", coherence);
    *may_drop = coherence < gscl_encode_tunables.max_probe_coherence;
    return GSCL_OK;
}

static gscl_result decide_shapes(effect_search *s, const gscl_image *image) {
    gscl_encoder *e = s->encoder;
    bool may_drop;
    double circles;
    GSCL_TRY(may_drop_shapes(e, image, &may_drop));
    if (!may_drop)
        return GSCL_OK;
    GSCL_TRY(measure_current_psnr(s));
    GSCL_TRY(probe_psnr(s, &e->source, SHAPES, s->missing_mse, &circles));
    const double gain_db = s->psnr - circles;
    decide_by_trial(&e->effects, SHAPES, gain_db > 0, gain_db);
    return GSCL_OK;
}

/* ---- All effects ---- */

static bool has_probe_fits(const gscl_encoder *e) {
    const gscl_encode_settings *s = &e->settings;
    const bool tiny = e->target.bytes && e->target.bytes < (size_t)gscl_encode_tunables.min_probe_bytes;
    return s->profile != GSCL_PROFILE_PAPER && s->effort > 0 && !tiny && !gscl_encode_is_background_only(e);
}

static gscl_result search_effects(gscl_encoder *e, const gscl_image *image) {
    effect_search s = {.encoder = e, .psnr = NAN};
    gscl_stage(e->context, GSCL_STAGE_EFFECT_SEARCH);
    gscl_stages_freeze(e->context, true);
    gscl_progress_stage(&e->progress, 0, 0);
    gscl_result result = decide_chroma(&s, image);
    if (result == GSCL_OK)
        result = decide_shapes(&s, image);
    gscl_progress_stage(&e->progress, 0, 1);
    gscl_stages_freeze(e->context, false);
    return result;
}

gscl_result gscl_encode_decide_effects(gscl_encoder *e, const gscl_image *image) {
    if (has_probe_fits(e))
        GSCL_TRY(search_effects(e, image));
    gscl_effects_set_header(&e->effects, &e->source.background, &e->header);
    gscl_effects_note(&e->effects, &e->source.background, &e->header);
    return GSCL_OK;
}
