#include "pack/field_steps.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "decode/coded_size.h"
#include "decode/dequantise.h"
#include "decode/quantise.h"
#include "pack/stored_splats.h"
#include "pack/tunables.h"
#include "runtime/elementary.h"
#include "runtime/stage_clock.h"

#define MOST_LEVELS 15 /* the code of most levels */

static double octaves_of_sets(const gscl_packing *p) {
    const struct gscl_pack_tunables *t = &gscl_pack_tunables;
    return gscl_log2(p->has_steps ? t->coarsest_factor : t->coarsest_factor / t->finest_factor);
}

int gscl_pack_step_sets(const gscl_packing *p) {
    return 2 + (int)rint(octaves_of_sets(p) * gscl_pack_tunables.steps_per_octave);
}

/* Opacity has 4 levels by default. */
static uint8_t opacity_step(double factor) {
    return (uint8_t)fmin(fmax(rint(4 / factor) - 1, 1), MOST_LEVELS);
}

/* The finest step of axes whose codes reach the longest one. */
static uint8_t least_scale_step(const gscl_packing *p) {
    const double octaves = p->log_longest_axis / gscl_ln(2) + 1;
    return (uint8_t)fmin(fmax(ceil(octaves * 32 / GSF_MAX_SCALE_CODE) - 4, 0), 15);
}

/* Steps of effects that are off are not stored. */
static gsf_steps used_steps(const gsf_header *header, gsf_steps steps) {
    steps.angle = header->has_rotation ? steps.angle : 0;
    steps.chroma = header->has_chroma ? steps.chroma : 0;
    steps.alpha = header->has_alpha ? steps.alpha : 0;
    steps.opacity = header->has_opacity ? steps.opacity : 0;
    steps.pivot = (uint8_t)gsf_typical_size(header, &steps);
    return steps;
}

static gsf_steps steps_of_field(const gscl_steps *s) {
    return (gsf_steps){s->scale, s->position, s->angle, s->luma, s->chroma, s->alpha, s->opacity, s->pivot};
}

/* From those of the field on, which its splats have exactly. */
static gsf_steps coarser_steps(const gscl_packing *p, int set) {
    const gsf_steps own = steps_of_field(&p->field->steps);
    return set == 0 ? own
                    : used_steps(&p->header,
                                 gscl_scale_steps(&own, gscl_exp2((double)set / gscl_pack_tunables.steps_per_octave)));
}

gsf_steps gscl_pack_steps(const gscl_packing *p, int set) {
    const struct gscl_pack_tunables *t = &gscl_pack_tunables;
    gsf_steps steps = {.luma = MOST_LEVELS, .chroma = MOST_LEVELS, .alpha = MOST_LEVELS, .opacity = MOST_LEVELS};
    if (p->has_steps)
        return coarser_steps(p, set);
    if (set > 0) {
        const double factor = t->finest_factor * gscl_exp2((double)(set - 1) / t->steps_per_octave);
        const gsf_steps defaults = gsf_default_steps(p->header.splat_count);
        steps = gscl_scale_steps(&defaults, factor);
        steps.opacity = opacity_step(factor);
    }
    if (steps.scale < least_scale_step(p))
        steps.scale = least_scale_step(p);
    return used_steps(&p->header, steps);
}

/* ---- Codes ---- */

/* Errors of the codes of a splat against its parameters. */
static void measure_errors(gscl_pack_report *r, const gscl_packing *p, const float *params, const gsf_splat *splat) {
    float stored[GSCL_PARAMS];
    gscl_dequantise(&p->coded.file, splat, stored);
    /* Axes may have changed their places. */
    const bool is_turned = params[GSCL_LOG_S1] < params[GSCL_LOG_S2];
    const double a = params[is_turned ? GSCL_LOG_S2 : GSCL_LOG_S1], b = params[is_turned ? GSCL_LOG_S1 : GSCL_LOG_S2];
    r->position_error = fmax(r->position_error, gscl_hypot((double)stored[GSCL_X] - params[GSCL_X],
                                                           (double)stored[GSCL_Y] - params[GSCL_Y]));
    r->axis_error = fmax(
        r->axis_error, fmax(fabs(gscl_exp(stored[GSCL_LOG_S1] - a) - 1), fabs(gscl_exp(stored[GSCL_LOG_S2] - b) - 1)));
    for (unsigned k = 0; k < gsf_channel_count(&p->header); k++)
        r->colour_error = fmax(r->colour_error, fabs((double)stored[GSCL_COLOUR + k] - params[GSCL_COLOUR + k]));
}

/* The codes of a splat.  Where its axes have the largest ratio, which longer ones are drawn with, too, their codes have it at least:
 * the nearest may have less. */
static void quantise_splat(const gsf_coded_image *file, const float *params, gsf_splat *splat) {
    const double ratio = (double)params[GSCL_LOG_S1] - params[GSCL_LOG_S2], largest = (double)GSCL_LOG_LARGEST_ASPECT;
    float extreme[GSCL_PARAMS];
    if (fabs(ratio) < largest - gscl_pack_tunables.rounding) {
        gscl_quantise(file, params, splat);
        return;
    }
    memcpy(extreme, params, sizeof extreme);
    extreme[ratio > 0 ? GSCL_LOG_S2 : GSCL_LOG_S1] -= (float)(0.49 * gscl_scale_step(&file->steps));
    gscl_quantise(file, extreme, splat);
}

/* Whether the mean of the stored colours is that of the field: splats that are left out or divided, or whose opacity is a factor of
 * the colour, change it. */
static bool has_mean_background(const gscl_packing *p) {
    const bool is_same = p->header.blend != GSF_BLEND_SUM && p->report->outside == 0;
    return p->field->has_mean_background && p->header.splat_count > 0 && (p->has_steps || is_same);
}

static void set_header(gscl_packing *p, const gsf_steps *steps) {
    gsf_coded_image *file = &p->coded.file;
    file->header = p->header;
    file->steps = *steps;
    file->bare = true;
    file->has_mean_background = has_mean_background(p);
    for (unsigned k = 0; k < gsf_channel_count(&p->header); k++)
        file->background[k] = gscl_quantise_background(&p->header, p->background[k]);
}

static double opacity_of(const float *params) {
    return 1 / (1 + gscl_exp(-params[GSCL_OPACITY]));
}

static bool are_alike(const float *given, const float *coded) {
    const struct gscl_pack_tunables *t = &gscl_pack_tunables;
    const bool is_circle = fabsf(coded[GSCL_LOG_S1] - coded[GSCL_LOG_S2]) < (float)t->rounding;
    for (int i = 0; i < GSCL_PARAMS; i++) {
        const bool is_place = i == GSCL_X || i == GSCL_Y, is_unused = i == GSCL_THETA && is_circle;
        const double allowed = is_place ? t->same_place : t->rounding * (1 + fabs((double)coded[i]));
        if (i != GSCL_OPACITY && !is_unused && !(fabs((double)given[i] - coded[i]) <= allowed))
            return false;
    }
    return fabs(opacity_of(given) - opacity_of(coded)) <= t->rounding;
}

bool gscl_pack_has_codes(gscl_packing *p) {
    const gsf_steps own = steps_of_field(&p->field->steps);
    float given[GSCL_PARAMS], coded[GSCL_PARAMS] = {0}; /* channels that are not coded stay 0 */
    gsf_splat splat;
    set_header(p, &own);
    for (size_t i = 0; i < p->field->count; i++) {
        gscl_pack_given_params(p, &p->field->splats[i], given);
        quantise_splat(&p->coded.file, given, &splat);
        gscl_dequantise(&p->coded.file, &splat, coded);
        if (coded[GSCL_WAVE_AMPLITUDE] == 0.0f)
            coded[GSCL_WAVE_X] = coded[GSCL_WAVE_Y] = coded[GSCL_WAVE_PHASE] = 0.0f;
        if (!are_alike(given, coded))
            return false;
    }
    return true;
}

/* Codes of the stored splats, in their order. */
static gscl_result quantise_splats(gscl_packing *p, const gsf_steps *steps, gscl_pack_report *report) {
    gsf_coded_image *file = &p->coded.file;
    set_header(p, steps);
    GSCL_TRY(gscl_coded_image_reserve(&p->coded, p->stored.count));
    gscl_stage(p->context, GSCL_STAGE_QUANTISE);
    for (size_t i = 0; i < p->stored.count; i++) {
        const float *params = p->stored.params + i * GSCL_PARAMS;
        quantise_splat(file, params, &file->splats[i]);
        file->splats[i].layer = p->layers ? p->layers[i] : 0;
        if (report)
            measure_errors(report, p, params, &file->splats[i]);
    }
    return GSCL_OK;
}

static gscl_result quantise(gscl_packing *p, const gsf_steps *steps, gscl_pack_report *report, size_t *size) {
    GSCL_TRY(quantise_splats(p, steps, report));
    GSCL_TRY(gscl_coded_image_sort(&p->coded, NULL));
    return gscl_file_size(p->context, &p->coded, size);
}

static void note_place(gscl_packing *p, size_t from, size_t to) {
    const double change = fabs((double)from - (double)to) / (double)p->stored.count;
    p->report->changed++;
    if (change <= p->worst.change)
        return;
    p->worst = (gscl_changed_splat){.number = from, .change = change};
    snprintf(p->worst.what, sizeof p->worst.what,
             "its place is %zu, and %zu where the longest are first, as in the format", from, to);
}

static void reorder(gscl_packing *p, const size_t *order, float *params) {
    for (size_t i = 0; i < p->stored.count; i++) {
        memcpy(params + i * GSCL_PARAMS, p->stored.params + order[i] * GSCL_PARAMS, GSCL_PARAMS * sizeof *params);
        if (order[i] != i)
            note_place(p, order[i], i);
    }
    free(p->stored.params);
    p->stored.params = params;
}

gscl_result gscl_pack_take_order(gscl_packing *p, const gsf_steps *steps) {
    const size_t count = p->stored.count;
    GSCL_TRY(quantise_splats(p, steps, NULL));
    size_t *order = malloc((count + 1) * sizeof *order);
    float *params = malloc((count + 1) * GSCL_PARAMS * sizeof *params);
    gscl_result result = order && params ? gscl_coded_image_sort(&p->coded, order) : gscl_fail_memory(p->context);
    if (result == GSCL_OK) {
        reorder(p, order, params);
        params = NULL;
    }
    free(order);
    free(params);
    return result;
}

gscl_result gscl_pack_quantise(gscl_packing *p, const gsf_steps *steps, size_t *size) {
    return quantise(p, steps, NULL, size);
}

gscl_result gscl_pack_quantise_measured(gscl_packing *p, const gsf_steps *steps, size_t *size) {
    p->report->position_error = p->report->axis_error = p->report->colour_error = 0;
    return quantise(p, steps, p->report, size);
}

/* Sizes decrease from set to set but for some bytes, which a search by halves does not mind. */
gscl_result gscl_pack_find_steps(gscl_packing *p, double bytes, int *set, size_t *size) {
    int low = -1, high = gscl_pack_step_sets(p); /* too large; small enough, or none */
    size_t last = 0;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        const gsf_steps steps = gscl_pack_steps(p, middle);
        GSCL_TRY(gscl_pack_quantise(p, &steps, &last));
        if ((double)last <= bytes) {
            high = middle;
            *size = last;
        } else {
            low = middle;
        }
    }
    if (high == gscl_pack_step_sets(p))
        *size = last; /* that of the coarsest, which was tried last */
    *set = high;
    return GSCL_OK;
}
