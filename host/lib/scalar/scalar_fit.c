/* The fit of the default profile: a pyramid, with scalar quantisation in the loop. */
#include "scalar/scalar_fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "decode/quantise.h"
#include "fit/density.h"
#include "runtime/timing.h"
#include "session/encode_trace.h"

#define GROW_ROUNDS 12            /* in which the others are added */
#define GROW_UNTIL 0.48           /* of the steps; then the number of splats stays */
#define MEASURE_ROUND 8           /* round after which real bits per splat replace the estimate */
#define QUANTISE_FROM 0.25        /* of the steps: from then on the fit looks through the quantiser */
#define QUARTER_UNTIL 0.3         /* of the steps at a quarter of the size, */
#define HALF_UNTIL 0.55           /* then at half the size, the rest at full size, where splats are this dense: */
#define DENSE 12.0                /* pixels from splat to splat; */
#define LONGEST_QUARTER 0.5       /* sparser ones stay longer with the small sizes, */
#define LONGEST_HALF 0.85         /* at most so long */
#define LOOK_INTERVAL 4           /* steps until it is asked again whether the next level is worth it */
#define LEAST_DETAIL 0.1          /* of the fit's error: less detail than this is not worth a level */
#define ROUNDING_DETAIL 0.98e-6   /* what rounding to 8 bits alone makes: (3/4 + 1/64) / 12 / 255^2 */
#define RATE 2.0                  /* on the learning rates in cl/update.cl */
#define LEAST_BITS_PER_SPLAT 26.0 /* less is what a half-done fit pretends */
#define ADAPT_AT 0.6              /* of the steps: tuned for SSIM, the target is adapted to what can be drawn */
#define ADAPT_AGAIN_AT 0.95       /* and once more */
#define REPORT_INTERVAL 25        /* steps */
#define SORT_INTERVAL 25          /* steps; blend alpha */

typedef gscl_scalar_state schedule;

/* cosine decay over the second half */
double gscl_scalar_learning_rate(double fraction) {
    return RATE * (fraction < 0.5 ? 1.0 : 0.02 + 0.98 * 0.5 * (1 + cos(3.14159265 * (fraction - 0.5) / 0.5)));
}

/* Pixels of the fitted image. */
double gscl_scalar_fitted_pixels(const gscl_encoder *e) {
    return ldexp((double)e->image->width * e->image->height, -2 * e->source.first_level);
}

/* Distance from splat to splat in the fitted image, in units of DENSE pixels. */
double gscl_scalar_sparseness(const schedule *s) {
    return sqrt(gscl_scalar_fitted_pixels(s->encoder) / (double)(s->target + 1)) / DENSE;
}

/* The level of the pyramid for this part of the steps: what splats are to show must be there to see. */
static int level_at(const schedule *s, double fraction) {
    double sparse = gscl_scalar_sparseness(s);
    int level = fraction < fmin(QUARTER_UNTIL * sparse, LONGEST_QUARTER) ? 2
                : fraction < fmin(HALF_UNTIL * sparse, LONGEST_HALF)     ? 1
                                                                         : 0;
    return s->encoder->source.first_level + (level > s->finest ? level : s->finest);
}

static gscl_result reserve_params(schedule *s, size_t count) {
    if (count <= s->capacity)
        return GSCL_OK;
    float *grown = realloc(s->params, count * GSCL_PARAMS * sizeof(float));
    if (!grown)
        return gscl_fail_memory(s->encoder->context);
    s->params = grown;
    s->capacity = count;
    return GSCL_OK;
}

gscl_result gscl_scalar_load(schedule *s) {
    float background[4];
    size_t count = s->encoder->coded.file.header.splat_count;
    GSCL_TRY(reserve_params(s, count));
    gscl_coded_image_params(&s->encoder->coded, s->params, background);
    return gscl_fit_replace(&s->fit, s->params, count);
}

gscl_result gscl_scalar_quantise(schedule *s) {
    gscl_coded_image *picture = &s->encoder->coded;
    size_t count = (size_t)s->fit.renderer.count;
    GSCL_TRY(reserve_params(s, count));
    GSCL_TRY(gscl_fit_read(&s->fit, s->params));
    picture->file.header.splat_count = (uint32_t)count;
    GSCL_TRY(gscl_coded_image_reserve(picture, count));
    for (size_t i = 0; i < count; i++)
        gscl_quantise(&picture->file, s->params + i * GSCL_PARAMS, &picture->file.splats[i]);
    return GSCL_OK;
}

/* How many splats the budget allows, from the bits that the splats of this moment take. */
static gscl_result measure_target(schedule *s) {
    size_t size;
    GSCL_TRY(gscl_scalar_quantise(s));
    GSCL_TRY(gscl_coded_image_sort(&s->encoder->coded, NULL));
    GSCL_TRY(gscl_encoder_size(s->encoder, &size));
    double count = s->fit.renderer.count, side = 20;
    double bits = fmax(((double)size - side) * 8 / count, LEAST_BITS_PER_SPLAT);
    double target = ((double)s->bytes - side) * 8 / bits * s->surplus;
    s->target = (size_t)fmin(fmax(target, 1), (double)s->most);
    return GSCL_OK;
}

/* `alpha` depends on the order: fits in the order in which the file will store the splats. */
static gscl_result sort_for_alpha(schedule *s) {
    size_t count = (size_t)s->fit.renderer.count;
    GSCL_TRY(gscl_scalar_quantise(s));
    size_t *order = malloc((count + 1) * sizeof *order);
    gscl_result result =
        order ? gscl_coded_image_sort(&s->encoder->coded, order) : gscl_fail_memory(s->encoder->context);
    if (result == GSCL_OK)
        result = gscl_fit_reorder(&s->fit, order, count);
    free(order);
    return result;
}

static gscl_result grow_round(schedule *s, int round) {
    if (s->bytes && round == MEASURE_ROUND)
        GSCL_TRY(measure_target(s));
    size_t want =
        s->start + (size_t)((double)(s->target - (s->target < s->start ? s->target : s->start)) * round / GROW_ROUNDS);
    size_t have = (size_t)s->fit.renderer.count;
    return want > have ? gscl_density_grow(&s->fit, want - have, &s->encoder->random) : GSCL_OK;
}

static gscl_result report(schedule *s, int step) {
    gscl_progress_state *progress = &s->encoder->progress;
    if (!progress->callback || step % REPORT_INTERVAL != 0)
        return GSCL_OK;
    double loss;
    GSCL_TRY(gscl_fit_loss(&s->fit, &loss));
    const gscl_encode_settings *settings = &s->encoder->settings;
    bool is_mse = settings->loss == GSCL_LOSS_L2 && settings->tune == GSCL_TUNE_PSNR;
    progress->psnr = is_mse && loss > 0 ? -10 * log10(loss) : 0;
    progress->splats = (uint32_t)s->fit.renderer.count;
    return gscl_progress_report(s->encoder->context, progress, GSCL_SCALAR_FIT_SHARE * step / s->steps);
}

gscl_result gscl_scalar_set_quantiser(schedule *s) {
    float steps[GSCL_STEP_COUNT];
    gscl_steps_to_floats(&s->encoder->coded.file.steps, steps);
    GSCL_TRY(gscl_renderer_set_steps(&s->fit.renderer, steps));
    return gscl_renderer_project(&s->fit.renderer);
}

/* Whether level `level` shows something that the fit, a level below, is fine enough for.  Where it does not, all
 * splats are so large that the smaller level shows them as well, in a fourth of the time. */
static gscl_result is_worth_a_level(schedule *s, int level, bool *worth) {
    gscl_fit *fit = &s->fit;
    const gscl_encode_settings *settings = &s->encoder->settings;
    double loss, *detail = &s->details[level];
    *worth = true;
    if (settings->loss != GSCL_LOSS_L2 || settings->tune != GSCL_TUNE_PSNR)
        return GSCL_OK; /* other losses do not compare */
    if (isnan(*detail)) {
        GSCL_TRY(gscl_fit_level_residual(fit, level, detail));
        if (!s->encoder->content.high_bit_depth)
            *detail -= ldexp(ROUNDING_DETAIL, -2 * level);
    }
    GSCL_TRY(gscl_fit_loss(fit, &loss));
    *worth = *detail > LEAST_DETAIL * loss;
    return GSCL_OK;
}

/* Goes on towards the level that is due, but no finer than the picture has something to show for. */
static gscl_result change_level(schedule *s, int step, int due) {
    int level = step == 0 ? due : s->fit.level;
    if (due < level && step >= s->next_look) {
        bool worth;
        GSCL_TRY(is_worth_a_level(s, level - 1, &worth));
        level -= worth;
        s->next_look = worth ? 0 : step + LOOK_INTERVAL;
    }
    if (step > 0 && level == s->fit.level)
        return GSCL_OK;
    GSCL_TRY(gscl_fit_set_level(&s->fit, level));
    gscl_stage(s->encoder->context, gscl_fit_stage(&s->fit));
    return GSCL_OK;
}

gscl_result gscl_scalar_run_steps(schedule *s) {
    int round = 0;
    bool quantising = false;
    for (int step = 0; step < s->steps; step++) {
        double fraction = (double)step / s->steps;
        GSCL_TRY(change_level(s, step, level_at(s, fraction)));
        if (step == 0)
            GSCL_TRY(gscl_density_seed(&s->fit, s->start, &s->encoder->random));
        if (!quantising && fraction >= QUANTISE_FROM) {
            quantising = true;
            GSCL_TRY(gscl_scalar_set_quantiser(s));
        }
        while (round < GROW_ROUNDS && fraction >= GROW_UNTIL * (round + 1) / GROW_ROUNDS)
            GSCL_TRY(grow_round(s, ++round));
        if (s->encoder->settings.blend == GSCL_BLEND_ALPHA && step % SORT_INTERVAL == 0)
            GSCL_TRY(sort_for_alpha(s));
        if (step == (int)(ADAPT_AT * s->steps) || step == (int)(ADAPT_AGAIN_AT * s->steps))
            GSCL_TRY(gscl_fit_adapt_target(&s->fit));
        GSCL_TRY(gscl_fit_step(&s->fit, (float)gscl_scalar_learning_rate(fraction)));
        GSCL_TRY(report(s, step));
        if ((step + 1) % gscl_trace_interval(s->steps) == 0)
            GSCL_TRY(gscl_trace_fit(s->encoder, &s->fit, step + 1));
    }
    return GSCL_OK;
}

gscl_result gscl_scalar_create_fit(schedule *s) {
    gscl_encoder *e = s->encoder;
    gscl_kernel_options options = gscl_coded_image_options(&e->coded.file.header);
    options.loss = gscl_loss_kind(e->settings.loss);
    options.weighted = e->settings.tune == GSCL_TUNE_SSIM;
    GSCL_TRY(gscl_fit_create(&s->fit, e->context, &options, e->image->width, e->image->height, e->source.first_level,
                             e->source.planes));
    if (e->source.background.pixels > 0)
        GSCL_TRY(gscl_fit_set_flat_background(&s->fit, &e->source.background));
    for (int k = 0; k < s->fit.renderer.channels; k++)
        e->coded.file.background[k] = gscl_quantise_background(&e->coded.file.header, s->fit.background[k]);
    return GSCL_OK;
}
