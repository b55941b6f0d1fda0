#include "pack/stored_splats.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "decode/blend.h"
#include "decode/dequantise.h"
#include "decode/ycocg.h"
#include "pack/cut_splat.h"
#include "pack/tunables.h"
#include "runtime/elementary.h"

static const double pi = 3.14159265358979323846, ln2 = 0.69314718055994530942;
static const double log_smallest_axis = -0.69314718055994530942; /* of 1/2 pixel */
static const double most_luma = 1.125;

static const struct gscl_pack_tunables *const tunables = &gscl_pack_tunables;

/* ---- The header ---- */

static bool is_grey(const float colour[4]) {
    return colour[0] == colour[1] && colour[0] == colour[2];
}

/* In the blend sum an opacity is a factor of the colour, which has finer codes; files keep theirs. */
static bool has_folded_opacity(const gscl_packing *p) {
    return p->header.blend == GSF_BLEND_SUM && !p->has_steps;
}

/* How far the cells of the finest steps reach, which cover a side: in pixels, for a splat of this major axis. */
static double reach_of_cells(uint32_t side, double major) {
    const double cell = fmax(8.0 / 256, major * 2 / 32);
    return ceil(side / cell) * cell;
}

/* The largest coordinates that the centre of a splat can have. */
static void limits_of_centre(const gsf_header *header, const gscl_splat *s, double most[2]) {
    const double major = fmin(fmax(fmax(s->sigma1, s->sigma2), 0.5), GSCL_MAX_DIMENSION);
    most[0] = reach_of_cells(header->width, major);
    most[1] = reach_of_cells(header->height, major);
}

/* Whether a splat has its centre where the format has none, outside 0..most, and has to get another one: see cut_splat.h. */
static bool is_outside(const gscl_packing *p, const gscl_splat *s, double most[2]) {
    if (p->has_steps) /* splats of a file are within all bounds */
        return false;
    limits_of_centre(&p->header, s, most);
    return s->x < 0 || s->y < 0 || s->x > most[0] || s->y > most[1];
}

static void note_effects(const gscl_packing *p, const gscl_splat *s, gsf_header *header) {
    double most[2];
    const bool is_cut = is_outside(p, s, most);
    header->has_chroma = header->has_chroma || (p->field->channels > 2 && !is_grey(s->colour));
    header->has_opacity = header->has_opacity || (!has_folded_opacity(p) && (is_cut || s->opacity != 1.0f));
    header->has_anisotropy = header->has_anisotropy || is_cut || s->sigma1 != s->sigma2;
    header->has_texture = header->has_texture || s->wave_amplitude != 0.0f;
    if (s->layer > header->enhancement_layers)
        header->enhancement_layers = (uint8_t)s->layer;
}

/* The coded channels of R, G, B and alpha. */
static void gather_colour(const gsf_header *header, const float colour[4], double factor, float *coded) {
    const int colours = header->has_chroma ? 3 : 1;
    for (int k = 0; k < colours; k++)
        coded[k] = (float)(colour[k] * factor);
    if (header->has_alpha)
        coded[colours] = (float)(colour[3] * factor);
}

void gscl_pack_describe(gscl_packing *p) {
    static const gsf_layout layouts[] = {GSF_GREY, GSF_GREY, GSF_GREY_ALPHA, GSF_RGB, GSF_RGBA};
    const gscl_field *f = p->field;
    gsf_header *header = &p->header;
    *header = (gsf_header){.blend = gscl_blend_to_format(f->blend),
                           .coding = GSF_CODING_SCALAR,
                           .layout = layouts[f->channels],
                           .high_bit_depth = f->sample > GSCL_SAMPLE_U8,
                           .has_chroma = f->channels > 2 && !is_grey(f->background),
                           .has_alpha = f->channels % 2 == 0,
                           .width = f->width,
                           .height = f->height};
    p->largest_weight = 1;
    for (size_t i = 0; i < f->count; i++) {
        note_effects(p, &f->splats[i], header);
        if (f->blend == GSCL_BLEND_NORMALIZED && f->splats[i].opacity > p->largest_weight)
            p->largest_weight = f->splats[i].opacity;
    }
    header->has_rotation = header->has_anisotropy;
    gather_colour(header, f->background, 1, p->background);
}

/* ---- Splats as they are ---- */

void gscl_pack_given_params(const gscl_packing *p, const gscl_splat *s, float *params) {
    const double factor = has_folded_opacity(p) ? s->opacity : 1;
    memset(params, 0, GSCL_PARAMS * sizeof *params);
    params[GSCL_X] = s->x;
    params[GSCL_Y] = s->y;
    params[GSCL_LOG_S1] = (float)gscl_ln(s->sigma1);
    params[GSCL_LOG_S2] = (float)gscl_ln(s->sigma2);
    params[GSCL_THETA] = s->theta;
    params[GSCL_OPACITY] = p->header.has_opacity ? gscl_logit(s->opacity / p->largest_weight) : GSCL_OPAQUE;
    gather_colour(&p->header, s->colour, factor, params + GSCL_COLOUR);
    if (s->wave_amplitude == 0.0f)
        return;
    params[GSCL_WAVE_X] = s->wave_x;
    params[GSCL_WAVE_Y] = s->wave_y;
    params[GSCL_WAVE_PHASE] = s->wave_phase;
    params[GSCL_WAVE_AMPLITUDE] = (float)(s->wave_amplitude * factor);
}

gscl_result gscl_pack_given_splats(const gscl_packing *p, gscl_splat_list *list) {
    *list = (gscl_splat_list){malloc((p->field->count + 1) * GSCL_PARAMS * sizeof(float)), p->field->count};
    if (!list->params)
        return gscl_fail_memory(p->context);
    for (size_t i = 0; i < list->count; i++)
        gscl_pack_given_params(p, &p->field->splats[i], list->params + i * GSCL_PARAMS);
    return GSCL_OK;
}

/* ---- Splats as the format can store them ---- */

/* The largest change of a splat so far: how much, and of what. */
typedef struct change {
    double amount; /* relative, or of the range of colours; 0: none */
    const char *name, *unit;
    double value, least, most;
} change;

/* Notes a change where it is more than rounding. */
static void note_amount(double amount, change named, change *largest) {
    if (amount <= tunables->rounding || amount <= largest->amount)
        return;
    *largest = named;
    largest->amount = amount;
}

/* Limits a parameter, and notes by how much. */
static double limited(double value, double least, double most, change named, change *largest) {
    const double result = fmin(fmax(value, least), most);
    note_amount(fabs(result - value), named, largest);
    return result;
}

/* Axes: each within its range, and the shorter one at least 1/256 of the longer one.  Returns the part of the weight with which
 * a splat that has grown draws as much as before. */
static double limit_axes(const gscl_splat *s, float *params, change *largest) {
    const change names[] = {{.name = "sigma1", .unit = " pixels", .value = s->sigma1, .least = 0.5, .most = 32768},
                            {.name = "sigma2", .unit = " pixels", .value = s->sigma2, .least = 0.5, .most = 32768}};
    const double most = (double)GSCL_LOG_LARGEST_AXIS;
    double a = limited(params[GSCL_LOG_S1], log_smallest_axis, most, names[0], largest);
    double b = limited(params[GSCL_LOG_S2], log_smallest_axis, most, names[1], largest);
    const change ratio = {.name = "the ratio of the axes",
                          .unit = "",
                          .value = gscl_exp(fabs((double)params[GSCL_LOG_S1] - params[GSCL_LOG_S2])),
                          .least = 1,
                          .most = 256};
    const double aspect = limited(fabs(a - b), 0, (double)GSCL_LOG_LARGEST_ASPECT, ratio, largest);
    if (a < b)
        a = b - aspect;
    else
        b = a - aspect;
    const double growth = a + b - params[GSCL_LOG_S1] - params[GSCL_LOG_S2];
    params[GSCL_LOG_S1] = (float)a;
    params[GSCL_LOG_S2] = (float)b;
    return gscl_exp(-fmax(growth, 0));
}

/* Brings the centre of a splat to the sides that it lies beyond.  Returns its weight there. */
static double limit_centre(const gscl_packing *p, const gscl_splat *s, float *params, change *largest) {
    double most[2];
    if (!is_outside(p, s, most))
        return 1;
    gscl_splat inside = *s;
    const gscl_cut cut = gscl_cut_at_sides(&inside, most);
    const bool is_y = cut.by_y > cut.by_x;
    const change moved = {
        .name = is_y ? "y" : "x", .unit = " pixels", .value = is_y ? s->y : s->x, .least = 0, .most = most[is_y]};
    note_amount(gscl_hypot(cut.by_x, cut.by_y), moved, largest);
    gscl_pack_given_params(p, &inside, params);
    return cut.weight;
}

/* Leaves a splat this share of its weight or, in the blend sum, of its colour.  Without either it keeps its weight. */
static void weaken(const gscl_packing *p, const gscl_splat *s, double share, float *params, change *largest) {
    const double weight = s->opacity * share / p->largest_weight;
    const change named = {.name = "opacity",
                          .unit = "",
                          .value = s->opacity * share,
                          .least = tunables->least_weight * p->largest_weight,
                          .most = p->largest_weight};
    if (p->header.has_opacity)
        params[GSCL_OPACITY] = gscl_logit(limited(weight, tunables->least_weight, 1, named, largest));
    if (!has_folded_opacity(p))
        return;
    for (int k = 0; k < 4; k++)
        params[GSCL_COLOUR + k] = (float)(params[GSCL_COLOUR + k] * share);
    params[GSCL_WAVE_AMPLITUDE] = (float)(params[GSCL_WAVE_AMPLITUDE] * share);
}

/* How many times the strongest colour that the format has in the blend sum a splat's colour is. */
static double strength(const gsf_header *header, const float *colour) {
    const int colours = header->has_chroma ? 3 : 1;
    double times = fabs(colour[0]) / most_luma;
    if (header->has_chroma) {
        const gscl_ycocg c = gscl_ycocg_from_rgb(colour);
        times = fmax(fabs(c.y) / most_luma, fmax(fabs(c.co), fabs(c.cg)));
    }
    return header->has_alpha ? fmax(times, fabs(colour[colours]) / most_luma) : times;
}

/* Splats of the blend sum that draw the same as this one together, each with an equal part of its colour. */
static size_t divide(const gsf_header *header, float *params) {
    const double times = strength(header, params + GSCL_COLOUR);
    if (header->blend != GSF_BLEND_SUM || times <= 1 + tunables->rounding)
        return 1;
    const double parts = fmin(ceil(times), GSCL_MAX_SPLATS);
    for (int k = 0; k < 4; k++)
        params[GSCL_COLOUR + k] = (float)(params[GSCL_COLOUR + k] / parts);
    params[GSCL_WAVE_AMPLITUDE] = (float)(params[GSCL_WAVE_AMPLITUDE] / parts);
    return (size_t)parts;
}

static double limit_luma(double value, const char *name, change *largest) {
    const change named = {.name = name, .unit = "", .value = value, .least = 1 - most_luma, .most = most_luma};
    return limited(value, named.least, named.most, named, largest);
}

static double limit_chroma(double value, const char *name, change *largest) {
    const change named = {.name = name, .unit = "", .value = value, .least = -1, .most = 1};
    return limited(value, -1, 1, named, largest);
}

/* Colours of the other blends, which are means: luma and the two differences each within their range. */
static void limit_colour(const gsf_header *header, float *colour, change *largest) {
    const int colours = header->has_chroma ? 3 : 1;
    if (header->blend == GSF_BLEND_SUM)
        return;
    if (header->has_chroma) {
        const gscl_ycocg c = gscl_ycocg_from_rgb(colour);
        const gscl_ycocg within = {limit_luma(c.y, "luma (red + 2 green + blue) / 4", largest),
                                   limit_chroma(c.co, "red - blue", largest),
                                   limit_chroma(c.cg, "green - (red + blue) / 2", largest)};
        if (within.y != c.y || within.co != c.co || within.cg != c.cg)
            gscl_ycocg_to_rgb(within, colour);
    } else {
        colour[0] = (float)limit_luma(colour[0], "grey", largest);
    }
    if (header->has_alpha)
        colour[colours] = (float)limit_luma(colour[colours], "alpha", largest);
}

static void limit_wave(const gscl_splat *s, float *params, change *largest) {
    if (params[GSCL_WAVE_AMPLITUDE] == 0.0f)
        return;
    const double frequency = gscl_hypot(params[GSCL_WAVE_X], params[GSCL_WAVE_Y]);
    const change named = {
        .name = "the wavelength", .unit = " pixels", .value = 1 / frequency, .least = 2.5, .most = 236.0};
    const change too_strong = {.name = "wave_amplitude", .unit = "", .value = s->wave_amplitude, .least = 0, .most = 1};
    if (params[GSCL_WAVE_AMPLITUDE] < 0) { /* half a turn later it is the same wave */
        params[GSCL_WAVE_AMPLITUDE] = -params[GSCL_WAVE_AMPLITUDE];
        params[GSCL_WAVE_PHASE] += 0.5f;
    }
    limited(gscl_ln(frequency * 2.5) / ln2, -15 * 0.4375, 0, named, largest);
    params[GSCL_WAVE_AMPLITUDE] = (float)limited(params[GSCL_WAVE_AMPLITUDE], 0, 1, too_strong, largest);
}

/* Whether the outline of a splat, where its weight ends, lies outside the image, or it has no weight or colour. */
static bool draws_nothing(const gscl_packing *p, const gscl_splat *s, const float *params) {
    const double reach = sqrt(2 * GSCL_SPLAT_CUTOFF), c = gscl_cos(s->theta), n = gscl_sin(s->theta);
    const double half_width = reach * gscl_hypot(c * s->sigma1, n * s->sigma2);
    const double half_height = reach * gscl_hypot(n * s->sigma1, c * s->sigma2);
    if (s->x + half_width <= 0 || s->x - half_width >= p->header.width || s->y + half_height <= 0 ||
        s->y - half_height >= p->header.height)
        return true;
    if (p->header.blend != GSF_BLEND_SUM)
        return s->opacity == 0.0f;
    return strength(&p->header, params + GSCL_COLOUR) == 0 && params[GSCL_WAVE_AMPLITUDE] == 0.0f;
}

static void note_change(gscl_packing *p, size_t number, const change *largest) {
    if (largest->amount == 0)
        return;
    p->report->changed++;
    if (largest->amount <= p->worst.change)
        return;
    p->worst = (gscl_changed_splat){.number = number, .change = largest->amount};
    snprintf(p->worst.what, sizeof p->worst.what, "%s is %.4g%s, the format has %.4g to %.4g", largest->name,
             largest->value, largest->unit, largest->least, largest->most);
}

static gscl_result append(gscl_packing *p, const float *params, size_t times, uint32_t layer, size_t *capacity) {
    gscl_splat_list *list = &p->stored;
    if (list->count + times > GSCL_MAX_SPLATS)
        return gscl_fail(
            p->context, GSCL_ERROR_FIELD,
            "the field has %zu splats, and more where colours are too strong for one; the format has at most %d",
            p->field->count, GSCL_MAX_SPLATS);
    if (list->count + times > *capacity) {
        const size_t wanted = (list->count + times) + (list->count + times) / 8;
        float *grown = realloc(list->params, wanted * GSCL_PARAMS * sizeof *grown);
        list->params = grown ? grown : list->params;
        uint32_t *layers = grown && p->layers ? realloc(p->layers, wanted * sizeof *layers) : NULL;
        if (!grown || (p->layers && !layers))
            return gscl_fail_memory(p->context);
        p->layers = layers;
        *capacity = wanted;
    }
    for (size_t i = 0; i < times; i++, list->count++) {
        memcpy(list->params + list->count * GSCL_PARAMS, params, GSCL_PARAMS * sizeof *params);
        if (p->layers)
            p->layers[list->count] = layer;
    }
    return GSCL_OK;
}

static double pixels_of(const gsf_header *header) {
    return (double)header->width * header->height;
}

/* What drawing a splat takes, as FORMAT.md bounds it under "Limits". */
static double work_of(const gsf_header *header, const float *params) {
    const double whole = 1 - 1e-6; /* an axis of n pixels is not above n by rounding */
    const double a = ceil(gscl_exp(params[GSCL_LOG_S1]) * whole), b = ceil(gscl_exp(params[GSCL_LOG_S2]) * whole);
    return fmin(pixels_of(header), 48 * a * b + 16 * (a + b) + 16);
}

static gscl_result store_splat(gscl_packing *p, size_t number, size_t *capacity) {
    const gscl_splat *s = &p->field->splats[number];
    float params[GSCL_PARAMS];
    change largest = {0};
    gscl_pack_given_params(p, s, params);
    if (!p->has_steps && draws_nothing(p, s, params)) {
        p->report->outside++;
        return GSCL_OK;
    }
    size_t parts = 1;
    if (!p->has_steps) { /* splats of a file are within all bounds */
        const double cut_share = limit_centre(p, s, params, &largest);
        const double grown_share = limit_axes(s, params, &largest);
        weaken(p, s, cut_share * grown_share, params, &largest);
        limit_colour(&p->header, params + GSCL_COLOUR, &largest);
        limit_wave(s, params, &largest);
        parts = divide(&p->header, params);
    }
    params[GSCL_THETA] = (float)(params[GSCL_THETA] - pi * floor(params[GSCL_THETA] / pi));
    p->report->divided += parts > 1;
    note_change(p, number, &largest);
    p->work += (double)parts * work_of(&p->header, params);
    p->log_longest_axis = fmax(p->log_longest_axis, fmax(params[GSCL_LOG_S1], params[GSCL_LOG_S2]));
    return append(p, params, parts, s->layer, capacity);
}

static gscl_result check_work(const gscl_packing *p) {
    const double most = 256 * pixels_of(&p->header) + 67108864.0;
    return p->work <= most
               ? GSCL_OK
               : gscl_fail(p->context, GSCL_ERROR_FIELD,
                           "the splats are so large that drawing takes %.3g evaluations; the format allows %.3g for "
                           "this size",
                           p->work, most);
}

gscl_result gscl_pack_store_splats(gscl_packing *p) {
    const size_t count = p->field->count;
    size_t capacity = count + 1;
    p->stored.params = malloc(capacity * GSCL_PARAMS * sizeof(float));
    if (p->header.enhancement_layers > 0)
        p->layers = malloc(capacity * sizeof *p->layers);
    if (!p->stored.params || (p->header.enhancement_layers > 0 && !p->layers))
        return gscl_fail_memory(p->context);
    for (size_t i = 0; i < count; i++)
        GSCL_TRY(store_splat(p, i, &capacity));
    p->header.splat_count = (uint32_t)p->stored.count;
    gscl_forget_effects_without_splats(&p->header);
    return check_work(p);
}
