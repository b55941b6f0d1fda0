/* The default profile: a pyramid fit with scalar quantisation in the loop, then rate-distortion passes. */
#include "scalar/encode_scalar.h"

#include <math.h>
#include <stdlib.h>

#include "decode/quantise.h"
#include "runtime/timing.h"
#include "scalar/byte_budget.h"
#include "scalar/scalar_fit.h"
#include "session/effects.h"

#define START_SHARE 0.3     /* of the splats are there at the first step */
#define SMALL_IMAGE 65536   /* pixels: up to here the finest level costs no time to speak of */
#define BITS_PER_SPLAT 34.0 /* first estimate */
#define SPARSE_SURPLUS 0.2  /* more surplus where splats are sparse; */
#define SPARSE_STEPS 0.6    /* there a step is quick, and more of them are made */
#define TEXTURE_EFFORT 1    /* from here on textures are looked for */
#define SKETCH_DENSE 12.0   /* sketches are made at full size where splats are closer, in pixels */

typedef gscl_scalar_state schedule;

/* What an effort pays for. */
typedef struct rung {
    int steps;       /* of the fit */
    int passes;      /* of refinement, besides the first and those that meet the budget */
    int finest;      /* level of the pyramid, counted from the fitted image */
    double surplus;  /* splats are fitted beyond the budget where refinement follows, which drops some again */
    double pressure; /* of the first pass: what is dropped too early does not come back */
} rung;

static const rung ladder[GSCL_MAX_EFFORT + 1] = {
    {60, 0, 1, 1.12, 1.0},    {100, 2, 0, 1.08, 0.5},   {180, 3, 0, 1.08, 0.5},  {300, 4, 0, 1.08, 0.5},
    {430, 5, 0, 1.08, 0.5},   {600, 6, 0, 1.08, 0.5},   {1000, 8, 0, 1.08, 0.5}, {1800, 10, 0, 1.08, 0.5},
    {3300, 14, 0, 1.08, 0.5}, {6000, 20, 0, 1.08, 0.5},
};

/* The order of `alpha` makes the change of one splat reach all others under it: not refined. */
static bool can_refine(const gscl_encoder *e) {
    return e->settings.blend != GSCL_BLEND_ALPHA;
}

/* Of the quantiser; the effects are settled. */
static void choose_steps(gscl_encoder *e) {
    const gsf_steps usual = {.scale = 6, .position = 8, .angle = 4, .luma = 8, .chroma = 4, .alpha = 4, .opacity = 3};
    gsf_coded_image *file = &e->coded.file;
    file->steps = usual;
    if (e->settings.step_factor > 0)
        file->steps = gscl_scale_steps(&usual, e->settings.step_factor);
    else if (e->source.background.pixels > 0)
        gscl_fit_steps_to_colour(file, e->source.background.colour);
}

static gscl_result fit_and_quantise(schedule *s) {
    gscl_encoder *e = s->encoder;
    GSCL_TRY(gscl_scalar_create_fit(s));
    GSCL_TRY(gscl_scalar_run_steps(s));
    if (gscl_effect_is_open(&e->settings, GSCL_EFFECT_TEXTURE) && s->fit.level > e->source.first_level + s->finest)
        s->textures = false; /* there is nothing to show that a wave could */
    gscl_stage(e->context, GSCL_STAGE_QUANTISE);
    GSCL_TRY(gscl_scalar_quantise(s));
    if (can_refine(e))
        GSCL_TRY(gscl_scalar_refine(s));
    return s->bytes ? gscl_scalar_trim(s) : GSCL_OK;
}

/* Settles the effects, and what to do for the budget. */
static schedule plan(gscl_encoder *e, const rung *r, size_t bytes, size_t splats) {
    schedule s = {.encoder = e,
                  .steps = r->steps,
                  .passes = r->passes,
                  .finest = gscl_scalar_fitted_pixels(e) > SMALL_IMAGE ? r->finest : 0,
                  .textures =
                      gscl_effect_wanted(&e->settings, GSCL_EFFECT_TEXTURE, e->settings.effort >= TEXTURE_EFFORT),
                  .bytes = bytes,
                  .keep_all = bytes == 0,
                  .target = splats,
                  .pressure = bytes ? r->pressure : 1};
    for (int i = 0; i < GSCL_MAX_LEVELS; i++)
        s.details[i] = NAN;
    gscl_effects_begin(e); /* a fit before may have decided otherwise */
    choose_steps(e);
    if (bytes)
        s.target = bytes > 24 ? (size_t)((double)(bytes - 20) * 8 / BITS_PER_SPLAT) + 1 : 0;
    double sparse = fmin(fmax(gscl_scalar_sparseness(&s) - 1, 0), 1);
    s.surplus = can_refine(e) ? r->surplus + SPARSE_SURPLUS * sparse : 1.0;
    s.steps += (int)(SPARSE_STEPS * sparse * s.steps);
    s.most = gscl_max_splats(e, bytes);
    if (s.target > s.most)
        s.target = s.most;
    s.start = (size_t)ceil((double)s.target * START_SHARE);
    return s;
}

gscl_result gscl_encode_scalar(gscl_encoder *e, size_t bytes, size_t splats) {
    schedule s = plan(e, &ladder[e->settings.effort], bytes, splats);
    gscl_result result = fit_and_quantise(&s);
    gscl_fit_free(&s.fit);
    free(s.params);
    return result;
}

/* ---- Sketches ---- */

static const rung sketch_rung = {.steps = 180, .surplus = 1.08};

/* The coarsest level that still shows what so many splats can. */
static int sketch_level(const schedule *s) {
    double pixels = gscl_scalar_fitted_pixels(s->encoder);
    int level = 0;
    while (pixels > SMALL_IMAGE && pixels / (double)(s->target + 1) > SKETCH_DENSE * SKETCH_DENSE) {
        pixels /= 4;
        level++;
    }
    return level;
}

/* Of what the fit shows now, through its quantiser, at its level. */
static gscl_result mean_error(gscl_fit *fit, double *mse) {
    double sum;
    GSCL_TRY(gscl_fit_rendering_error(fit, &sum));
    *mse = sum / ((double)gscl_fit_level_pixels(fit) * fit->renderer.channels);
    return GSCL_OK;
}

gscl_result gscl_scalar_probe_fit(gscl_encoder *e, size_t bytes, size_t splats, double *mse) {
    uint64_t random = e->random;
    schedule s = plan(e, &sketch_rung, bytes, splats);
    s.finest = sketch_level(&s);
    gscl_result result = gscl_scalar_create_fit(&s);
    if (result == GSCL_OK)
        result = gscl_scalar_run_steps(&s);
    if (result == GSCL_OK)
        result = mean_error(&s.fit, mse);
    gscl_fit_free(&s.fit);
    free(s.params);
    e->random = random;
    return result;
}
