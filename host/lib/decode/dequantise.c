#include "decode/dequantise.h"

#include <string.h>

#include "cl/constants.h"
#include "decode/ycocg.h"
#include "runtime/elementary.h"

static const gscl_real pi = GSCL_REAL(3.14159265358979323846), ln2 = GSCL_REAL(0.69314718055994530942);

gscl_real gscl_scale_step(const gsf_steps *s) {
    return (gscl_real)(s->scale + 4) / 32 * ln2;
}

gscl_real gscl_amplitude_step(const gsf_steps *s) {
    return GSCL_REAL(2) / (gscl_real)(3 * gsf_colour_levels(s->luma));
}

float gscl_logit(gscl_real opacity) {
    const gscl_real lowest = GSCL_REAL(0x1p-100), highest = GSCL_REAL(1 - 1e-7);
    const gscl_real o = gscl_real_min(gscl_real_max(opacity, lowest), highest);
    return (float)gscl_ln(o / (1 - o));
}

void gscl_dequantise_colour(const gsf_coded_image *p, const gsf_splat *s, float *colour) {
    const unsigned fineness = gsf_colour_fineness(&p->steps, s->major, s->aspect);
    const gscl_real y = (gscl_real)s->luma / (gscl_real)(gsf_colour_levels(p->steps.luma) * fineness);
    colour[0] = (float)y;
    if (p->header.has_chroma) {
        const gscl_real levels = (gscl_real)(gsf_colour_levels(p->steps.chroma) * fineness);
        gscl_ycocg_to_rgb((gscl_ycocg){y, s->co / levels, s->cg / levels}, colour);
    }
    if (p->header.has_alpha)
        colour[p->header.has_chroma ? 3 : 1] =
            (float)((gscl_real)s->alpha / (gscl_real)gsf_colour_levels(p->steps.alpha));
}

/* Positions are multiples of 1/512 pixel, which a float represents exactly. */
static float scalar_position(uint32_t code, uint32_t step, uint32_t parts) {
    return (float)((2 * (uint64_t)code + 1) * step / parts) / 512.0f;
}

static float codebook_position(uint32_t code, unsigned bits, uint32_t dimension) {
    return (float)((2 * (uint64_t)code + 1) * dimension * 256 >> bits) / 512.0f;
}

/* The shorter axis counts as at least a certain part of the longer one. */
static void dequantise_axes(gscl_real log_s1, gscl_real log_s2, float *params) {
    const gscl_real largest_aspect = (gscl_real)GSCL_LOG_LARGEST_ASPECT;
    params[GSCL_LOG_S1] = (float)gscl_real_max(log_s1, log_s2 - largest_aspect);
    params[GSCL_LOG_S2] = (float)gscl_real_max(log_s2, log_s1 - largest_aspect);
}

static void dequantise_texture(const gsf_coded_image *p, const gsf_texture *t, float *params) {
    gscl_real frequency = 1 / (gscl_real)GSCL_FIRST_WAVELENGTH, cosine = 1, sine = 0;
    if (t->amplitude > 0) { /* most splats have no wave, and these functions are slow */
        const gscl_real direction = t->direction * pi / GSF_DIRECTIONS;
        frequency *= gscl_exp2(-(gscl_real)GSCL_OCTAVES_PER_WAVE * t->wave);
        cosine = gscl_cos(direction);
        sine = gscl_sin(direction);
    }
    const gscl_real amplitude = t->amplitude * gscl_amplitude_step(&p->steps);
    params[GSCL_WAVE_X] = (float)(frequency * cosine);
    params[GSCL_WAVE_Y] = (float)(frequency * sine);
    params[GSCL_WAVE_PHASE] = (float)t->phase / GSF_PHASES;
    params[GSCL_WAVE_AMPLITUDE] = params[GSCL_LOG_S1] > GSCL_LOG_LARGEST_WAVED_AXIS
                                      ? 0.0f
                                      : (float)gscl_real_min(amplitude, (gscl_real)GSCL_LARGEST_AMPLITUDE);
}

void gscl_dequantise(const gsf_coded_image *p, const gsf_splat *s, float *params) {
    const gsf_splat_grid grid = gsf_splat_grid_of(&p->header, &p->steps, s);
    const gscl_real step = gscl_scale_step(&p->steps), largest = (gscl_real)GSCL_LOG_LARGEST_AXIS;
    params[GSCL_X] = scalar_position(s->x, grid.step, grid.parts_x);
    params[GSCL_Y] = scalar_position(s->y, grid.step, grid.parts_y);
    dequantise_axes(gscl_real_min(s->major * step - ln2, largest),
                    gscl_real_min((s->major - s->aspect) * step - ln2, largest), params);
    params[GSCL_THETA] = 0.0f;
    if (p->header.has_rotation)
        params[GSCL_THETA] = (float)(s->angle * pi / (gscl_real)gsf_angle_count(&p->steps, s->aspect));
    params[GSCL_OPACITY] = GSCL_OPAQUE;
    if (p->header.has_opacity)
        params[GSCL_OPACITY] = gscl_logit((gscl_real)(s->opacity + 1) / (p->steps.opacity + 1));
    gscl_dequantise_colour(p, s, params + GSCL_COLOUR);
    dequantise_texture(p, &s->texture, params);
}

/* Paper eq. 7: a code between the ends of its range. */
static gscl_real from_range(const gsf_range *range, unsigned code, unsigned bits) {
    const gscl_real length = (gscl_real)(range->max - range->min);
    return (gscl_real)range->min + (gscl_real)code * length / (gscl_real)((1u << bits) - 1u);
}

/* ln of an axis of a shape word. */
static gscl_real log_of_axis(const gsf_codebooks *books, const uint16_t *shape, unsigned axis) {
    return (from_range(&books->shape[axis], shape[axis], books->shape_bits) / 32 - 4) * ln2;
}

void gscl_dequantise_indexed(const gsf_coded_image *p, const gsf_indexed_splat *s, float *params) {
    memset(params, 0, GSCL_PARAMS * sizeof *params);
    const gsf_codebooks *books = &p->codebooks;
    const uint16_t *shape = books->shape_words[s->shape], *colour = books->colour_words[s->colour];
    const unsigned channels = gsf_channel_count(&p->header);
    params[GSCL_X] = codebook_position(s->x, books->position_bits, p->header.width);
    params[GSCL_Y] = codebook_position(s->y, books->position_bits, p->header.height);
    dequantise_axes(log_of_axis(books, shape, 0), log_of_axis(books, shape, 1), params);
    params[GSCL_THETA] = (float)(from_range(&books->shape[2], shape[2], books->shape_bits) * pi / 256);
    for (unsigned k = 0; k < channels; k++)
        params[GSCL_COLOUR + k] = (float)(from_range(&books->colour[k], colour[k], books->colour_bits) / 255);
    params[GSCL_OPACITY] =
        p->header.has_opacity
            ? gscl_logit(from_range(&books->colour[channels], colour[channels], books->colour_bits) / 255)
            : GSCL_OPAQUE;
}

void gscl_dequantise_splat(const gsf_coded_image *p, uint32_t i, float *params) {
    if (p->header.coding == GSF_CODING_SCALAR)
        gscl_dequantise(p, &p->splats[i], params);
    else
        gscl_dequantise_indexed(p, &p->indexed[i], params);
}

void gscl_dequantise_background(const gsf_coded_image *p, const gscl_real colour_sums[4], float background[4]) {
    const gsf_header *header = &p->header;
    const bool is_mean = p->has_mean_background && header->splat_count > 0;
    for (unsigned k = 0; k < gsf_channel_count(header); k++)
        background[k] = is_mean ? (float)(colour_sums[k] / (gscl_real)header->splat_count)
                                : (float)p->background[k] / (header->high_bit_depth ? 65535.0f : 255.0f);
}
