#include "format/attributes.h"

#include "format/quantiser.h"

/* These numbers are part of the format: FORMAT.md, "Adaptive models". */
static const gsf_model_shape ASPECT = {2, 40, 4, {32, 24, 12}, 96};
static const gsf_model_shape DIRECTION = {64, 0, 1, {16, 6, 0}, 256};
static const gsf_model_shape LUMA = {8, 0, 1, {32, 20, 10}, 192};
static const gsf_model_shape ALPHA = {4, 0, 1, {32, 8, 2}, 256};
static const gsf_model_shape OPACITY = {16, 0, 1, {32, 8, 0}, 256};
static const gsf_model_shape TEXTURED = {64, 0, 1, {24, 0, 0}, 1024};
static const gsf_model_shape WAVE = {12, 0, 1, {24, 10, 0}, 192};
static const gsf_model_shape AMPLITUDE = {2, 40, 2, {32, 12, 4}, 192};
enum { ASPECT_CENTRE = 4 };

void gsf_attributes_init(gsf_attributes *a, const gsf_header *header, const gsf_steps *steps) {
    int min, max;
    a->header = *header;
    a->steps = *steps;
    gsf_model_init(&a->aspect, &ASPECT, GSF_MAX_SCALE_CODE + 1, ASPECT_CENTRE);
    gsf_model_init(&a->direction, &DIRECTION, GSF_DIRECTIONS, 0);
    gsf_luma_range(header->blend, steps->luma, &min, &max);
    a->luma_min = min;
    gsf_model_init(&a->luma, &LUMA, (uint32_t)(max - min + 1), 0);
    gsf_luma_range(header->blend, steps->alpha, &min, &max);
    a->alpha_min = min;
    gsf_model_init(&a->alpha, &ALPHA, (uint32_t)(max - min + 1), 0);
    gsf_model_init(&a->opacity, &OPACITY, steps->opacity + 1u, 0);
    gsf_model_init(&a->textured, &TEXTURED, 2, 0);
    gsf_model_init(&a->amplitude, &AMPLITUDE, GSF_AMPLITUDES, 0);
    gsf_model_init(&a->wave, &WAVE, GSF_WAVES, 0);
    gsf_model_init(&a->wave_direction, &DIRECTION, GSF_DIRECTIONS, 0);
    gsf_chroma_range(steps->chroma, &min, &max);
    gsf_chroma_init(&a->chroma, max);
}

/* The first code of a bin of directions.  Bins are centred on multiples of pi / GSF_DIRECTIONS, so that bin 0 begins
 * with the codes just below `count`, here negative numbers modulo 2^32. */
static uint32_t first_in_bin(uint32_t bin, uint32_t count) {
    const uint32_t width = 2 * GSF_DIRECTIONS; /* of half a turn, in half bins */
    return (count * (2 * bin + width - 1) + width - 1) / width - count;
}

static uint32_t bin_of(uint32_t code, uint32_t count) {
    return (2 * GSF_DIRECTIONS * code + count) / (2 * count) % GSF_DIRECTIONS;
}

/* Bins 0 and 15 are neighbours, unlike the first and last symbol of other models. */
static void update_direction(gsf_model *model, uint32_t bin) {
    gsf_model_update(model, bin);
    if (bin == 0)
        gsf_model_add(model, GSF_DIRECTIONS - 1, model->gain[1]);
    if (bin == GSF_DIRECTIONS - 1)
        gsf_model_add(model, 0, model->gain[1]);
}

/* Codes the bin, in proportion to its frequency and its number of codes, then the code within the bin. */
static uint32_t code_angle(gsf_coder *coder, gsf_model *model, uint32_t count, uint32_t code) {
    const uint32_t per_bin = (count + GSF_DIRECTIONS - 1) / GSF_DIRECTIONS;
    uint16_t freq[GSF_DIRECTIONS];
    uint32_t total = 0;
    for (uint32_t i = 0; i < GSF_DIRECTIONS; i++) {
        const uint32_t codes = first_in_bin(i + 1, count) - first_in_bin(i, count);
        freq[i] = codes == 0 ? 0 : (uint16_t)(1 + model->freq[i] * codes / per_bin);
        total += freq[i];
    }
    const uint32_t bin = gsf_code_symbol(coder, bin_of(code, count), freq, GSF_DIRECTIONS, total);
    const uint32_t first = first_in_bin(bin, count);
    const uint32_t codes = first_in_bin(bin + 1, count) - first;
    const uint32_t offset = gsf_code_uniform(coder, (code - first + count) % count, codes);
    update_direction(model, bin);
    return (first + offset + count) % count;
}

static void code_shape(gsf_coder *coder, gsf_attributes *a, gsf_splat *splat) {
    coder->stream = GSF_STREAM_SCALE;
    if (a->header.has_anisotropy)
        splat->aspect = (uint16_t)gsf_code_with_model(coder, splat->aspect, &a->aspect);
    coder->stream = GSF_STREAM_ANGLE;
    const unsigned angles = a->header.has_rotation ? gsf_angle_count(&a->steps, splat->aspect) : 1;
    if (angles > 1)
        splat->angle = (uint16_t)code_angle(coder, &a->direction, angles, splat->angle);
}

/* The bucket of the splat's centre along one axis, 0..GSF_PYRAMID_SIDE - 1. */
static uint32_t bucket_at(const gsf_attributes *a, const gsf_splat *splat, uint32_t cell, uint32_t dimension) {
    const uint64_t step = gsf_position_step_q8(&a->steps, splat->minor);
    const uint64_t index = (2 * (uint64_t)cell + 1) * step * GSF_PYRAMID_SIDE / (512 * (uint64_t)dimension);
    return index < GSF_PYRAMID_SIDE ? (uint32_t)index : GSF_PYRAMID_SIDE - 1;
}

/* Codes a value that may be negative: symbol 0 of the model is `min`. */
static int16_t code_from(gsf_coder *coder, gsf_model *model, int min, int16_t code) {
    return (int16_t)((int)gsf_code_with_model(coder, (uint32_t)(code - min), model) + min);
}

static void code_chroma(gsf_coder *coder, gsf_attributes *a, gsf_splat *splat) {
    const uint32_t bucket_x = bucket_at(a, splat, splat->x, a->header.width);
    const uint32_t bucket_y = bucket_at(a, splat, splat->y, a->header.height);
    int16_t code[2] = {splat->co, splat->cg};
    gsf_code_chroma(coder, &a->chroma, bucket_x, bucket_y, code);
    splat->co = code[0];
    splat->cg = code[1];
}

static void code_texture(gsf_coder *coder, gsf_attributes *a, gsf_texture *t) {
    if (!gsf_code_with_model(coder, t->amplitude > 0, &a->textured)) {
        *t = (gsf_texture){0};
        return;
    }
    t->amplitude = (uint8_t)(1 + gsf_code_with_model(coder, t->amplitude - 1u, &a->amplitude));
    t->wave = (uint8_t)gsf_code_with_model(coder, t->wave, &a->wave);
    gsf_model *directions = &a->wave_direction;
    t->direction = (uint8_t)gsf_code_symbol(coder, t->direction, directions->freq, GSF_DIRECTIONS, directions->total);
    update_direction(directions, t->direction);
    t->phase = (uint8_t)gsf_code_uniform(coder, t->phase, GSF_PHASES);
}

void gsf_code_attributes(gsf_coder *coder, gsf_attributes *attributes, gsf_splat *splat) {
    gsf_attributes *a = attributes;
    code_shape(coder, a, splat);
    coder->stream = GSF_STREAM_LUMA;
    splat->luma = code_from(coder, &a->luma, a->luma_min, splat->luma);
    coder->stream = GSF_STREAM_CHROMA;
    if (a->header.has_chroma)
        code_chroma(coder, a, splat);
    coder->stream = GSF_STREAM_ALPHA;
    if (a->header.has_alpha)
        splat->alpha = code_from(coder, &a->alpha, a->alpha_min, splat->alpha);
    coder->stream = GSF_STREAM_OPACITY;
    if (a->header.has_opacity)
        splat->opacity = (uint16_t)gsf_code_with_model(coder, splat->opacity, &a->opacity);
    coder->stream = GSF_STREAM_TEXTURE;
    if (a->header.has_texture)
        code_texture(coder, a, &splat->texture);
}
