#include "scalar/scalar_state.h"

#include <math.h>
#include <stdlib.h>

#include "cl/constants.h"
#include "decode/quantise.h"
#include "format/packet.h"
#include "format/quantiser.h"
#include "runtime/elementary.h"
#include "scalar/search_plan.h"

/* Splats that the budget is expected to hold. */
static size_t estimate_splats(size_t bytes, uint32_t packets) {
    const double header = packets > 0 ? (double)packets * (GSCL_HEADER_BYTES + GSF_PACKET_FRAME) : GSCL_HEADER_BYTES;
    const double bits = 8 * ((double)bytes - header);
    return bits > 32 ? (size_t)(bits / gscl_scalar_tunables.expected_bits_per_splat) + 1 : 0;
}

/* The base layer's steps are those of all layers. */
static void choose_quantiser_steps(const gscl_scalar_state *s, gscl_size_target all) {
    const double factor = s->encoder->settings.step_factor;
    gsf_coded_image *file = &s->coded->file;
    if (s->fixed_count > 0 || s->is_given)
        return;
    gsf_header header = file->header;
    header.splat_count = (uint32_t)(all.bytes ? estimate_splats(all.bytes, s->coded->packets) : all.splats);
    const gsf_steps defaults = gsf_default_steps(header.splat_count);
    file->steps = factor > 0 ? gscl_scale_steps(&defaults, factor) : defaults;
    file->steps.pivot = (uint8_t)gsf_typical_size(&header, &file->steps);
    if (factor <= 0 && s->source->background.pixels > 0)
        gscl_fit_steps_to_colour(file, s->source->background.colour);
}

double gscl_scalar_relative_spacing(const gscl_scalar_state *s) {
    return sqrt(s->source_pixels / (double)(s->target + 1)) / gscl_scalar_tunables.full_size_distance;
}

static bool has_distance_below(const gscl_scalar_state *s, double limit) {
    return gscl_scalar_relative_spacing(s) * gscl_scalar_tunables.full_size_distance < limit;
}

/* Where splats lie too far apart to represent structure, a loss that is to raise a perceptual metric lowers it. */
int gscl_scalar_weighting(const gscl_scalar_state *s) {
    switch (s->encoder->settings.tune) {
    case GSCL_TUNE_SSIM:
        return has_distance_below(s, gscl_scalar_tunables.max_weighted_distance) ? GSCL_WEIGHTED_PIXELS
                                                                                 : GSCL_WEIGHTED_NOT;
    case GSCL_TUNE_VISUAL:
        return has_distance_below(s, gscl_scalar_tunables.max_visual_distance) ? GSCL_WEIGHTED_LUMA : GSCL_WEIGHTED_NOT;
    default:
        return GSCL_WEIGHTED_NOT;
    }
}

/* Small files are searched.  Layers of a progressive file are not, because the splats before them do not change. */
static bool is_searched(const gscl_scalar_state *s, const gscl_scalar_plan *plan) {
    return !s->is_given && s->has_choice && s->bytes > 0 && s->bytes < (size_t)gscl_scalar_tunables.max_search_bytes &&
           plan->preset->searches > 0 && plan->coded->file.header.enhancement_layers == 0 &&
           s->encoder->settings.loss == GSCL_LOSS_L2 && gscl_scalar_weighting(s) != GSCL_WEIGHTED_LUMA;
}

/* The number of splats that the target holds. */
static size_t choose_target(const gscl_scalar_state *s, gscl_size_target target) {
    const size_t splats = s->is_given ? s->coded->file.header.splat_count
                          : s->bytes  ? estimate_splats(s->bytes, s->coded->packets)
                                      : target.splats;
    return splats < s->max_splats ? splats : s->max_splats;
}

/* A searched file begins with the same fit in all efforts that search. */
static void choose_search(gscl_scalar_state *s, const gscl_scalar_plan *plan) {
    const struct gscl_scalar_tunables *t = &gscl_scalar_tunables;
    s->passes_end = 1;
    if (!is_searched(s, plan))
        return;
    s->finest = gscl_search_level(s->source_pixels, s->target);
    s->is_searched = true;
    s->starts = plan->preset->searches * t->search_starts;
    s->ends_search = (s->start_index + 1) % t->search_starts == 0;
    s->rounds = gscl_search_rounds(s->source_pixels, s->finest, t->search_rounds);
    s->combinations = gscl_search_rounds(s->source_pixels, s->finest, t->search_combinations);
    s->waves_at_end = s->textures && gscl_effect_is_on(&s->encoder->effects, GSCL_EFFECT_TEXTURE,
                                                       s->bytes >= (size_t)t->search_wave_bytes);
    s->textures = false;
    s->fit_end = t->search_fit_share;
    s->passes_end = t->search_passes_share;
}

bool gscl_scalar_is_launch_bound(const gscl_scalar_state *s) {
    return s->encoder->context->gpu_mapping && s->source_pixels <= gscl_scalar_tunables.launch_bound_pixels;
}

/* The share of an effort's steps and passes that an image of this size has. */
static double share_of_size(const gscl_scalar_state *s) {
    const struct gscl_scalar_tunables *t = &gscl_scalar_tunables;
    const double size = fmax(s->source_pixels / t->large_image_pixels, 1);
    return fmax(gscl_pow(size, -t->large_image_exponent), t->least_share);
}

/* Steps of the fit: more where splats are far apart, fewer of large images. */
static int choose_steps(const gscl_scalar_state *s, const gscl_scalar_plan *plan, double spacing) {
    const struct gscl_scalar_tunables *t = &gscl_scalar_tunables;
    const double steps = s->is_searched ? t->search_first_steps : plan->preset->steps;
    const double wide = gscl_scalar_is_launch_bound(s) ? t->launch_bound_wide_steps : t->wide_steps;
    return (int)(steps * (1 + wide * spacing) * share_of_size(s));
}

/* The number of splats before and after densification, and the steps of the fit. */
static void choose_counts(gscl_scalar_state *s, const gscl_scalar_plan *plan) {
    const struct gscl_scalar_tunables *t = &gscl_scalar_tunables;
    const double spacing = fmin(fmax(gscl_scalar_relative_spacing(s) - 1, 0), 1);
    s->surplus = s->has_choice ? plan->preset->surplus + t->wide_surplus * spacing : 1.0;
    s->steps = choose_steps(s, plan, spacing);
    s->passes = (int)ceil((s->is_searched ? t->search_first_passes : plan->preset->passes) * share_of_size(s));
    const size_t own = s->target - (s->fixed_count < s->target ? s->fixed_count : s->target);
    s->start = s->fixed_count + (size_t)ceil((double)own * t->start_share);
}

void gscl_scalar_begin(gscl_scalar_state *s, gscl_encoder *e, const gscl_scalar_plan *plan, int start_index) {
    const gscl_source *source = plan->source;
    const double pixels = ldexp((double)source->image_width * source->image_height, -2 * source->first_level);
    const size_t bytes = plan->target.bytes;
    *s = (gscl_scalar_state){.encoder = e,
                             .source = source,
                             .source_pixels = pixels,
                             .bytes = bytes,
                             .max_splats = bytes ? e->max_splats : GSCL_MAX_SPLATS,
                             .full_share = plan->preset->full_share,
                             .final_gain = plan->preset->final_gain,
                             .finest = pixels > gscl_scalar_tunables.small_image_pixels ? plan->preset->finest : 0,
                             /* In blend alpha a splat changes all others under it, which the passes do not follow. */
                             .has_choice = e->settings.blend != GSCL_BLEND_ALPHA,
                             .is_given = plan->is_given,
                             .fixed = plan->fixed,
                             .fixed_count = plan->fixed_count,
                             .layer = plan->layer,
                             .coded = plan->coded,
                             .starts = 1,
                             .start_index = start_index,
                             .random = e->settings.seed + (uint64_t)start_index,
                             .textures = plan->layer == plan->coded->file.header.enhancement_layers && /* the last */
                                         gscl_effect_is_on(&e->effects, GSCL_EFFECT_TEXTURE,
                                                           e->settings.effort >= gscl_scalar_tunables.texture_effort),
                             .keep_all = bytes == 0,
                             .lambda_scale = bytes ? plan->preset->lambda_scale : 1};
    for (int i = 0; i < GSCL_MAX_LEVELS; i++)
        s->residuals[i] = NAN;
    choose_quantiser_steps(s, plan->all);
    s->target = choose_target(s, plan->target);
    choose_search(s, plan);
    s->is_last_fit = plan->is_last && !s->is_searched; /* a search may fit again */
    choose_counts(s, plan);
}

void gscl_scalar_end(gscl_scalar_state *s) {
    gscl_scalar_rdo_free(&s->rdo, s->encoder->context);
    gscl_fit_free(&s->fit);
    free(s->params);
}

static gscl_result reserve_params(gscl_scalar_state *s, size_t count) {
    if (count <= s->capacity)
        return GSCL_OK;
    float *grown = realloc(s->params, count * GSCL_PARAMS * sizeof(float));
    if (!grown)
        return gscl_fail_memory(s->encoder->context);
    s->params = grown;
    s->capacity = count;
    return GSCL_OK;
}

static void quantise_splat(gscl_scalar_state *s, size_t i) {
    gsf_coded_image *file = &s->coded->file;
    gsf_splat *splat = &file->splats[i];
    if (i < s->fixed_count) {
        *splat = s->fixed[i];
        return;
    }
    gscl_quantise(file, s->params + i * GSCL_PARAMS, splat);
    splat->layer = s->layer;
}

gscl_result gscl_scalar_quantise(gscl_scalar_state *s) {
    gscl_coded_image *coded = s->coded;
    const size_t count = (size_t)s->fit.renderer.count;
    GSCL_TRY(reserve_params(s, count));
    GSCL_TRY(gscl_fit_read(&s->fit, s->params));
    coded->file.header.splat_count = (uint32_t)count;
    GSCL_TRY(gscl_coded_image_reserve(coded, count));
    for (size_t i = 0; i < count; i++)
        quantise_splat(s, i);
    return GSCL_OK;
}

gscl_result gscl_scalar_load(gscl_scalar_state *s) {
    float background[4];
    const size_t count = s->coded->file.header.splat_count;
    GSCL_TRY(reserve_params(s, count));
    gscl_coded_image_params(s->coded, s->params, background);
    return gscl_fit_replace(&s->fit, s->params, count, background);
}

bool gscl_scalar_is_within_budget(const gscl_scalar_state *s) {
    return s->size <= s->bytes && s->coded->file.header.splat_count > 0;
}

gscl_result gscl_scalar_measure_rendering(gscl_scalar_state *s) {
    const double samples = (double)gscl_fit_level_pixels(&s->fit) * s->fit.renderer.channels;
    GSCL_TRY(gscl_fit_squared_error(&s->fit, &s->fit.renderer.image, &s->known_error));
    s->known_error /= samples;
    return GSCL_OK;
}

gscl_result gscl_scalar_update_size(gscl_scalar_state *s) {
    GSCL_TRY(gscl_coded_image_sort(s->coded, NULL));
    return gscl_file_size(s->encoder->context, s->coded, &s->size);
}

gscl_result gscl_scalar_set_quantiser(gscl_scalar_state *s) {
    float steps[GSCL_STEP_COUNT];
    gscl_steps_to_floats(&s->coded->file.steps, steps);
    GSCL_TRY(gscl_renderer_set_steps(&s->fit.renderer, steps));
    return gscl_renderer_project(&s->fit.renderer);
}

bool gscl_scalar_has_squared_error(const gscl_scalar_state *s) {
    return s->encoder->settings.loss == GSCL_LOSS_L2 && s->fit.renderer.options.weighted != GSCL_WEIGHTED_PIXELS;
}
