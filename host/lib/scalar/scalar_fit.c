#include "scalar/scalar_fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "decode/dequantise.h"
#include "decode/quantise.h"
#include "fit/density.h"
#include "runtime/elementary.h"
#include "runtime/launch.h"
#include "runtime/queue.h"
#include "runtime/stage_clock.h"
#include "scalar/fit_levels.h"
#include "scalar/scalar_progress.h"
#include "scalar/visual_model.h"
#include "session/encode_trace.h"

static const struct gscl_scalar_tunables *const tunables = &gscl_scalar_tunables;

/* The learning rate at this fraction of the steps: cosine decay over the second half. */
static float learning_rate(double fraction) {
    const double min = tunables->min_learning_rate, angle = 3.14159265 * (fraction - 0.5) / 0.5;
    return (float)(tunables->learning_rate * (fraction < 0.5 ? 1.0 : min + (1 - min) * 0.5 * (1 + gscl_cos(angle))));
}

/* The factor on the learning rate where the fit is nearly exact.  The steps of Adam do not shrink with the error: beyond some
 * error they would be its largest part. */
static float nearness(const gscl_scalar_state *s) {
    const double ratio = s->known_error / tunables->full_rate_above;
    return s->known_error > 0 && ratio < 1 ? (float)fmax(sqrt(ratio), tunables->least_nearness) : 1.0f;
}

/* 1: the steps of the fit see all rows of the image at this fraction of them; 2: every second one. */
static int row_step(const gscl_scalar_state *s, double fraction) {
    const bool is_nearly_exact = s->known_error > 0 && s->known_error < tunables->all_rows_below;
    const bool has_few_steps = s->steps < tunables->min_sampled_steps;
    const bool has_low_splats = s->fit.known_low_splats > tunables->max_low_splats;
    return has_few_steps || fraction >= tunables->all_rows_from || is_nearly_exact || has_low_splats ? 1 : 2;
}

/* Whether the file may leave the background to the mean of its splats.  In the blend normalized splats mostly cover the
 * image, and a background of its own takes 25 bits or more. */
static bool hides_background(const gscl_scalar_state *s) {
    return s->coded->file.header.blend == GSF_BLEND_NORMALIZED && s->source->background.pixels == 0 &&
           s->target >= (size_t)tunables->min_covering_splats;
}

/* The programs of the fit, and then those of the passes after it: first without waves, then with them. */
static void prefetch_programs(const gscl_scalar_state *s, const gscl_kernel_options *options) {
    gscl_kernel_options textured = *options;
    textured.texture = true;
    gscl_program_request requests[6] = {{GSCL_PROGRAM_RENDER, *options}, {GSCL_PROGRAM_FIT, *options}};
    size_t count = 2;
    if (options->weighted != GSCL_WEIGHTED_NOT)
        requests[count++] = (gscl_program_request){
            options->weighted == GSCL_WEIGHTED_LUMA ? GSCL_PROGRAM_VISUAL : GSCL_PROGRAM_SSIM, *options};
    if (s->has_choice)
        requests[count++] = (gscl_program_request){GSCL_PROGRAM_SCALAR_RDO, *options};
    if (s->has_choice && s->textures) {
        requests[count++] = (gscl_program_request){GSCL_PROGRAM_RENDER, textured};
        requests[count++] = (gscl_program_request){GSCL_PROGRAM_SCALAR_RDO, textured};
    }
    gscl_prefetch(s->encoder->context, requests, count);
}

static gscl_result create_fit(gscl_scalar_state *s) {
    const gscl_encoder *e = s->encoder;
    const gscl_source *source = s->source;
    gsf_coded_image *file = &s->coded->file;
    gscl_kernel_options options = gscl_coded_image_options(&file->header);
    options.loss = e->loss_kind;
    options.weighted = gscl_scalar_weighting(s);
    prefetch_programs(s, &options);
    GSCL_TRY(gscl_fit_create(&s->fit, e->context, &options, source->image_width, source->image_height,
                             source->first_level, source->planes));
    if (s->is_last_fit)
        gscl_encoder_release_source(s->encoder);
    if (source->background.pixels > 0)
        GSCL_TRY(gscl_fit_set_flat_background(&s->fit, &source->background));
    if (s->is_given)
        return GSCL_OK;
    for (int k = 0; k < s->fit.renderer.channels; k++)
        file->background[k] = gscl_quantise_background(&file->header, s->fit.background[k]);
    file->has_mean_background = hides_background(s);
    return GSCL_OK;
}

/* ---- Levels of the pyramid ---- */

/* Measures the error of the splats at the current level: state->known_error. */
static gscl_result measure_fit(gscl_scalar_state *s) {
    if (s->fit.model_level < 0)
        return gscl_fit_loss(&s->fit, &s->known_error);
    GSCL_TRY(gscl_fit_render(&s->fit));
    return gscl_scalar_measure_rendering(s);
}

/* Measures the residual of a level, if it is not known yet, and the error of the splats, in one wait. */
static gscl_result measure_level(gscl_scalar_state *s, int level) {
    double *residual = &s->residuals[level];
    gscl_context *context = s->encoder->context;
    float *map = NULL;
    gscl_result result = isnan(*residual) ? gscl_fit_begin_level_residual(&s->fit, level, &map) : GSCL_OK;
    if (result == GSCL_OK)
        result = measure_fit(s);
    if (result == GSCL_OK && map) {
        *residual = gscl_fit_level_residual(&s->fit, level, map);
        if (!s->encoder->content.high_bit_depth)
            *residual -= ldexp(tunables->rounding_residual, -2 * level);
    }
    gscl_release_after_copies(context, map);
    return result;
}

/* Whether level `level` has detail that the splats, fitted at the next coarser level, can represent.  Otherwise all
 * splats are so large that a fit at the coarser level is as good, in a quarter of the time. */
static gscl_result needs_level(gscl_scalar_state *s, int level, bool *needed) {
    *needed = true;
    if (!gscl_scalar_has_squared_error(s))
        return GSCL_OK;
    GSCL_TRY(measure_level(s, level));
    *needed = s->residuals[level] > tunables->min_level_residual * s->known_error;
    return GSCL_OK;
}

/* Moves one level towards the level that is due, unless the finer level has no detail for the splats. */
static gscl_result change_level(gscl_scalar_state *s, int step, int due) {
    int level = step == 0 ? due : s->fit.level;
    if (due < level && step >= s->next_level_check) {
        bool needed;
        GSCL_TRY(needs_level(s, level - 1, &needed));
        level -= needed;
        s->next_level_check = needed ? 0 : step + tunables->level_check_interval;
    }
    if (step > 0 && level == s->fit.level)
        return GSCL_OK;
    gscl_stage(s->encoder->context, gscl_fit_stage(&s->fit, level)); /* before the device has work again */
    GSCL_TRY(gscl_fit_set_level(&s->fit, level));
    if (step > 0) /* smaller levels have served; of a large image they would take a third of the target's memory */
        gscl_pyramid_release_smaller(&s->fit.pyramid, level);
    return GSCL_OK;
}

/* ---- Number of splats ---- */

/* Sets the target number of splats from the bits that a splat takes in the current fit. */
static gscl_result estimate_target(gscl_scalar_state *s) {
    size_t size;
    GSCL_TRY(gscl_scalar_quantise(s));
    GSCL_TRY(gscl_coded_image_sort(s->coded, NULL));
    GSCL_TRY(gscl_file_size(s->encoder->context, s->coded, &size));
    const double count = s->fit.renderer.count;
    const double bits = fmax(((double)size - GSCL_HEADER_BYTES) * 8 / count, tunables->min_bits_per_splat);
    const double target = ((double)s->bytes - GSCL_HEADER_BYTES) * 8 / bits * s->surplus;
    s->target = (size_t)fmin(fmax(target, 1), (double)s->max_splats);
    return GSCL_OK;
}

static gscl_result densify_in_round(gscl_scalar_state *s, int round) {
    if (s->bytes && round == tunables->measure_round)
        GSCL_TRY(estimate_target(s));
    const size_t added = s->target - (s->target < s->start ? s->target : s->start);
    const size_t wanted = s->start + (size_t)((double)added * round / tunables->densify_rounds);
    const size_t count = (size_t)s->fit.renderer.count;
    return wanted > count ? gscl_density_grow(&s->fit, wanted - count, &s->random) : GSCL_OK;
}

/* Sorts the splats as the file will store them: blend alpha depends on their order. */
static gscl_result sort_for_alpha(gscl_scalar_state *s) {
    const size_t count = (size_t)s->fit.renderer.count;
    GSCL_TRY(gscl_scalar_quantise(s));
    size_t *order = malloc((count + 1) * sizeof *order);
    gscl_result result = order ? gscl_coded_image_sort(s->coded, order) : gscl_fail_memory(s->encoder->context);
    if (result == GSCL_OK)
        result = gscl_fit_reorder(&s->fit, order, count);
    free(order);
    return result;
}

/* ---- Steps ---- */

/* Whether step `step` is the one at this share of all steps. */
static bool is_step_at(const gscl_scalar_state *s, int step, double share) {
    return step == (int)(share * s->steps);
}

/* The first splats of the fit: after those of the layers before, where there are any. */
static gscl_result place_first_splats(gscl_scalar_state *s) {
    gsf_coded_image *file = &s->coded->file;
    if (s->fixed_count == 0)
        return gscl_density_seed(&s->fit, s->start, &s->random);
    file->header.splat_count = (uint32_t)s->fixed_count;
    GSCL_TRY(gscl_coded_image_reserve(s->coded, s->fixed_count));
    memcpy(file->splats, s->fixed, s->fixed_count * sizeof *s->fixed);
    GSCL_TRY(gscl_scalar_load(s));
    s->fit.fixed = s->fixed_count;
    return gscl_density_grow(&s->fit, s->start - s->fixed_count, &s->random);
}

/* Sets the level, the splats and the target before step `step`.  `round`: last densification round so far. */
static gscl_result prepare_step(gscl_scalar_state *s, int step, int *round, bool *quantising) {
    const double fraction = (double)step / s->steps;
    GSCL_TRY(change_level(s, step, gscl_scalar_level_due(s, fraction)));
    if (step == 0)
        GSCL_TRY(place_first_splats(s));
    if (!*quantising && fraction >= tunables->quantise_from) {
        *quantising = true;
        GSCL_TRY(gscl_scalar_set_quantiser(s));
    }
    while (*round < tunables->densify_rounds &&
           fraction >= tunables->densify_until * (*round + 1) / tunables->densify_rounds)
        GSCL_TRY(densify_in_round(s, ++*round));
    if (s->encoder->settings.blend == GSCL_BLEND_ALPHA && step % tunables->sort_interval == 0)
        GSCL_TRY(sort_for_alpha(s));
    if (is_step_at(s, step, tunables->adapt_at) || is_step_at(s, step, tunables->adapt_again_at))
        GSCL_TRY(gscl_fit_adapt_target(&s->fit));
    return gscl_scalar_renew_model(s, step);
}

gscl_result gscl_scalar_fit(gscl_scalar_state *s) {
    int round = 0;
    bool quantising = false;
    GSCL_TRY(create_fit(s));
    if (!s->is_searched)
        gscl_scalar_expect_fit_end(s);
    for (int step = 0; step < s->steps; step++) {
        GSCL_TRY(prepare_step(s, step, &round, &quantising));
        const double fraction = (double)step / s->steps;
        GSCL_TRY(gscl_fit_step(&s->fit, learning_rate(fraction) * nearness(s), row_step(s, fraction)));
        if (s->fit.model_level < 0)
            s->known_error = s->fit.known_loss; /* of an earlier step, without waiting */
        GSCL_TRY(gscl_scalar_report_step(s, step));
        if ((step + 1) % gscl_trace_interval(s->steps) == 0)
            GSCL_TRY(gscl_trace_fit(s->encoder, &s->fit, step + 1));
    }
    return gscl_fit_set_rows(&s->fit, 1);
}

gscl_result gscl_scalar_take_given(gscl_scalar_state *s) {
    GSCL_TRY(create_fit(s));
    s->fit_end = 0;
    GSCL_TRY(gscl_fit_set_level(&s->fit, s->source->first_level));
    return gscl_scalar_load(s);
}

gscl_result gscl_scalar_refit(gscl_scalar_state *s, size_t new_splats, int steps) {
    gscl_kernel_options options = s->fit.renderer.options;
    options.texture = s->coded->file.header.has_texture;
    gscl_renderer_set_options(&s->fit.renderer, &options);
    gscl_stage(s->encoder->context, GSCL_STAGE_REFIT);
    gscl_scalar_rdo_release_plane(&s->rdo);
    GSCL_TRY(gscl_scalar_load(s));
    GSCL_TRY(gscl_scalar_set_quantiser(s));
    GSCL_TRY(gscl_density_grow(&s->fit, new_splats, &s->random));
    for (int step = 0; step < steps; step++) {
        if (step % gscl_scalar_model_interval(s) == 0)
            GSCL_TRY(gscl_fit_renew_model(&s->fit));
        const double fraction = 0.5 + 0.5 * (step + 0.5) / steps;
        GSCL_TRY(gscl_fit_step(&s->fit, learning_rate(fraction) * nearness(s), row_step(s, fraction)));
    }
    GSCL_TRY(gscl_fit_set_rows(&s->fit, 1));
    return gscl_scalar_quantise(s);
}

/* Projects the coded splats as they are: they are quantised already. */
static gscl_result project_codes(gscl_scalar_state *s) {
    gscl_kernel_options options = s->fit.renderer.options;
    options.texture = s->coded->file.header.has_texture;
    gscl_renderer_set_options(&s->fit.renderer, &options);
    GSCL_TRY(gscl_scalar_load(s));
    GSCL_TRY(gscl_renderer_set_steps(&s->fit.renderer, NULL));
    return gscl_renderer_project(&s->fit.renderer);
}

gscl_result gscl_scalar_choose_background(gscl_scalar_state *s) {
    static const gscl_real no_sums[4]; /* of colours, of which a stored background needs none */
    gsf_coded_image *file = &s->coded->file;
    gscl_renderer *r = &s->fit.renderer;
    float stored[4];
    double with_stored;
    if (!file->has_mean_background || file->header.splat_count == 0)
        return GSCL_OK;
    GSCL_TRY(project_codes(s));
    GSCL_TRY(gscl_fit_render(&s->fit));
    GSCL_TRY(gscl_fit_begin_squared_error(&s->fit, &r->image));
    file->has_mean_background = false;
    gscl_dequantise_background(&s->coded->file, no_sums, stored);
    GSCL_TRY(gscl_renderer_set_background(r, stored));
    GSCL_TRY(gscl_renderer_draw(r));
    GSCL_TRY(gscl_fit_squared_error(&s->fit, &r->image, &with_stored));
    file->has_mean_background =
        (double)s->fit.reading->squared_error <= tunables->max_mean_error * with_stored; /* that with the mean */
    return GSCL_OK;
}

gscl_result gscl_scalar_measure(gscl_scalar_state *s, double *error) {
    *error = INFINITY;
    if (s->coded->file.header.splat_count == 0)
        return GSCL_OK;
    GSCL_TRY(project_codes(s));
    return gscl_fit_rendering_error(&s->fit, error);
}

gscl_result gscl_scalar_measure_pixels(gscl_scalar_state *s, float *error) {
    GSCL_TRY(project_codes(s));
    return gscl_fit_error(&s->fit, error);
}
