#include "format/attributes.h"

#include "format/quantiser.h"
#include "format/tables.h"

/* These numbers are part of the format: FORMAT.md, "Adaptive models". */
static const gsf_model_shape WAVE_DIRECTION = {64, 0, 1, {16, 6, 0}, 256};
static const gsf_model_shape LUMA = {8, 0, 1, {32, 20, 10}, 192};
static const gsf_model_shape ALPHA = {4, 0, 1, {32, 8, 2}, 256};
static const gsf_model_shape OPACITY = {16, 0, 1, {32, 8, 0}, 256};
const gsf_conditional_shape gsf_aspect_shape = {gsf_aspect_table,
                                                GSF_ASPECT_ROWS,
                                                GSF_ASPECT_COLUMNS,
                                                false,
                                                {4, 2, 1}};
const gsf_conditional_shape gsf_direction_shape = {gsf_direction_table,
                                                   GSF_DIRECTION_ROWS,
                                                   GSF_DIRECTION_COLUMNS,
                                                   true,
                                                   {7, 1, 0}};
static const gsf_conditional_shape TEXTURED = {gsf_textured_table, GSF_TEXTURED_ROWS, 2, false, {10, 0, 0}};
static const gsf_conditional_shape AMPLITUDE = {gsf_amplitude_table, 1, GSF_AMPLITUDES, false, {5, 2, 1}};
static const gsf_conditional_shape WAVE = {gsf_wave_table, 1, GSF_WAVES, false, {5, 2, 0}};
enum { LAST_ASPECT = GSF_ASPECT_COLUMNS - 1 };

/* Dark colours are more frequent than bright ones, and those outside 0..1 rare. */
static void start_luma(gsf_model *model, int min, int levels) {
    model->total = 0;
    for (int i = 0; i < (int)model->count; i++) {
        const int code = i + min;
        model->freq[i] = (uint16_t)(code < 0 || code > levels ? 1 : 5 + 9 * (levels - code) / levels);
        model->total += model->freq[i];
    }
}

void gsf_attributes_init(gsf_attributes *a, const gsf_header *header, const gsf_steps *steps) {
    int min, max;
    a->header = *header;
    a->steps = *steps;
    a->typical_size = gsf_typical_size(header, steps);
    for (unsigned i = 0; i <= GSF_MAX_SCALE_CODE; i++) {
        a->angles[i] = (uint16_t)gsf_angle_count(steps, i);
        a->parts[i] = gsf_position_parts(steps, i);
    }
    gsf_conditional_init(&a->aspect, &gsf_aspect_shape);
    gsf_conditional_init(&a->direction, &gsf_direction_shape);
    gsf_conditional_init(&a->textured, &TEXTURED);
    /* The rows of these are by size, and in a layer the largest splats come first. */
    a->aspect.descending = a->textured.descending = header->enhancement_layers == 0;
    gsf_conditional_init(&a->amplitude, &AMPLITUDE);
    gsf_conditional_init(&a->wave, &WAVE);
    gsf_luma_range(header->blend, steps->luma, 1, &min, &max);
    a->luma_min = min;
    gsf_model_init(&a->luma, &LUMA, a->luma_freq, (uint32_t)(max - min + 1), 0);
    if (header->blend != GSF_BLEND_SUM)
        start_luma(&a->luma, min, (int)gsf_colour_levels(steps->luma));
    gsf_luma_range(header->blend, steps->alpha, 1, &min, &max);
    a->alpha_min = min;
    gsf_model_init(&a->alpha, &ALPHA, a->alpha_freq, (uint32_t)(max - min + 1), 0);
    gsf_model_init(&a->opacity, &OPACITY, a->opacity_freq, steps->opacity + 1u, 0);
    gsf_model_init(&a->wave_direction, &WAVE_DIRECTION, a->direction_freq, GSF_DIRECTIONS, 0);
    gsf_chroma_range(steps->chroma, 1, &min, &max);
    gsf_chroma_init(&a->chroma, max);
}

/* The first code of a bin of directions.  Bins are centred on multiples of pi / GSF_DIRECTIONS, so that bin 0 begins
 * with the codes just below `count`, here negative numbers modulo 2^32. */
static uint32_t first_in_bin(uint32_t bin, uint32_t count) {
    const uint32_t width = 2 * GSF_DIRECTIONS; /* of half a turn, in half bins */
    return (count * (2 * bin + width - 1) + width - 1) / width - count;
}

uint32_t gsf_direction_of(uint32_t code, uint32_t count) {
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

uint32_t gsf_direction_row(unsigned aspect) {
    return aspect / 2 < GSF_DIRECTION_ROWS ? aspect / 2 : GSF_DIRECTION_ROWS - 1;
}

uint32_t gsf_aspect_row(unsigned major, unsigned typical) {
    return gsf_size_row(major, typical, GSF_ASPECT_BELOW, GSF_ASPECT_ROWS);
}

/* An aspect is at most the major code.  Aspects from LAST_ASPECT on share a symbol. */
static uint16_t code_aspect(gsf_coder *coder, gsf_attributes *a, const gsf_splat *splat) {
    const uint32_t row = gsf_aspect_row(splat->major, a->typical_size);
    const uint32_t known = splat->aspect < LAST_ASPECT ? splat->aspect : LAST_ASPECT;
    if (splat->major < LAST_ASPECT)
        return (uint16_t)gsf_code_conditional_below(coder, known, &a->aspect, row, splat->major + 1u);
    const uint32_t symbol = gsf_code_conditional(coder, known, &a->aspect, row);
    if (symbol < LAST_ASPECT)
        return (uint16_t)symbol;
    return (uint16_t)(symbol + gsf_code_uniform(coder, splat->aspect - symbol, splat->major + 1u - symbol));
}

/* Codes the bin, in proportion to its frequency and its number of codes, then the code within the bin. */
static uint32_t code_angle(gsf_coder *coder, gsf_conditional *model, uint32_t row, uint32_t count, uint32_t code) {
    const uint32_t per_bin = (count + GSF_DIRECTIONS - 1) / GSF_DIRECTIONS;
    const uint32_t share = 65536 / per_bin; /* of a bin's frequency, for each code in it */
    const uint16_t *directions = gsf_conditional_row(model, row);
    uint16_t freq[GSF_DIRECTIONS];
    uint32_t total = 0;
    for (uint32_t i = 0; i < GSF_DIRECTIONS; i++) {
        const uint32_t codes = first_in_bin(i + 1, count) - first_in_bin(i, count);
        freq[i] = codes == 0 ? 0 : (uint16_t)(1 + (directions[i] * codes * share >> 16));
        total += freq[i];
    }
    const uint32_t bin = gsf_code_symbol(coder, gsf_direction_of(code, count), freq, GSF_DIRECTIONS, total);
    const uint32_t first = first_in_bin(bin, count);
    const uint32_t codes = first_in_bin(bin + 1, count) - first;
    const uint32_t offset = gsf_code_uniform(coder, (code - first + count) % count, codes);
    gsf_conditional_update(model, row, bin);
    return (first + offset + count) % count;
}

/* Codes the part of the cell across the major axis.  Before, a decoder has the cell of the class in x and y. */
static void code_part(gsf_coder *coder, gsf_splat *splat, uint32_t parts, bool steep) {
    uint32_t *place = steep ? &splat->x : &splat->y;
    const uint32_t cell = GSF_DECODING(coder) || parts == 1 ? *place : *place / parts;
    *place = cell * parts + gsf_code_uniform(coder, *place - cell * parts, parts);
}

static void code_shape(gsf_coder *coder, gsf_attributes *a, gsf_splat *splat) {
    gsf_coder_count_in(coder, GSF_STREAM_SCALE);
    if (a->header.has_anisotropy)
        splat->aspect = code_aspect(coder, a, splat);
    gsf_coder_count_in(coder, GSF_STREAM_ANGLE);
    const unsigned angles = a->header.has_rotation ? a->angles[splat->aspect] : 1;
    if (angles > 1)
        splat->angle =
            (uint16_t)code_angle(coder, &a->direction, gsf_direction_row(splat->aspect), angles, splat->angle);
    gsf_coder_count_in(coder, GSF_STREAM_POSITION);
    const uint32_t parts = a->parts[splat->aspect];
    const bool steep = gsf_angle_is_steep(splat->angle, angles);
    code_part(coder, splat, parts, steep);
    a->parts_x = steep ? parts : 1;
    a->parts_y = steep ? 1 : parts;
}

/* The bucket of the splat's centre along one axis, 0..GSF_PYRAMID_SIDE - 1. */
static uint32_t bucket_at(uint32_t step, uint32_t cell, uint32_t parts, uint32_t dimension) {
    const uint64_t index = (2 * (uint64_t)cell + 1) * step * GSF_PYRAMID_SIDE / (512 * (uint64_t)dimension * parts);
    return index < GSF_PYRAMID_SIDE ? (uint32_t)index : GSF_PYRAMID_SIDE - 1;
}

/* Codes a value that may be negative: symbol 0 of the model is `min`. */
static int16_t code_from(gsf_coder *coder, gsf_model *model, int min, int16_t code) {
    return (int16_t)((int)gsf_code_with_model(coder, (uint32_t)(code - min), model) + min);
}

/* The level of a code of luma or chroma; a decoder has none yet. */
static int16_t level_of(const gsf_coder *coder, int code, unsigned fineness) {
    return (int16_t)(GSF_DECODING(coder) ? 0 : gsf_colour_level(code, fineness));
}

/* The part of a level, after which its code is known. */
static int16_t code_part_of_level(gsf_coder *coder, int level, unsigned fineness, int code) {
    const int first = level * (int)fineness;
    return (int16_t)(first + (int)gsf_code_uniform(coder, (uint32_t)(code - first), fineness));
}

static void code_luma(gsf_coder *coder, gsf_attributes *a, gsf_splat *splat) {
    const int level = code_from(coder, &a->luma, a->luma_min, level_of(coder, splat->luma, a->fineness));
    splat->luma = code_part_of_level(coder, level, a->fineness, splat->luma);
}

static void code_chroma(gsf_coder *coder, gsf_attributes *a, gsf_splat *splat) {
    const uint32_t step = gsf_position_step_q8(&a->steps, splat->major);
    const uint32_t bucket_x = bucket_at(step, splat->x, a->parts_x, a->header.width);
    const uint32_t bucket_y = bucket_at(step, splat->y, a->parts_y, a->header.height);
    int16_t level[2] = {level_of(coder, splat->co, a->fineness), level_of(coder, splat->cg, a->fineness)};
    gsf_code_chroma(coder, &a->chroma, bucket_x, bucket_y, level);
    splat->co = code_part_of_level(coder, level[0], a->fineness, splat->co);
    splat->cg = code_part_of_level(coder, level[1], a->fineness, splat->cg);
}

static void code_texture(gsf_coder *coder, gsf_attributes *a, gsf_splat *splat) {
    gsf_texture *t = &splat->texture;
    const uint32_t row = gsf_size_row(splat->major, a->typical_size, 2 * GSF_TEXTURED_BELOW, 2 * GSF_TEXTURED_ROWS) / 2;
    if (!gsf_code_conditional(coder, t->amplitude > 0, &a->textured, row)) {
        *t = (gsf_texture){0};
        return;
    }
    t->amplitude = (uint8_t)(1 + gsf_code_conditional(coder, t->amplitude - 1u, &a->amplitude, 0));
    t->wave = (uint8_t)gsf_code_conditional(coder, t->wave, &a->wave, 0);
    gsf_model *directions = &a->wave_direction;
    t->direction = (uint8_t)gsf_code_symbol(coder, t->direction, directions->freq, GSF_DIRECTIONS, directions->total);
    update_direction(directions, t->direction);
    t->phase = (uint8_t)gsf_code_uniform(coder, t->phase, GSF_PHASES);
}

void gsf_code_attributes(gsf_coder *coder, gsf_attributes *attributes, gsf_splat *splat) {
    gsf_attributes *a = attributes;
    code_shape(coder, a, splat);
    gsf_coder_count_in(coder, GSF_STREAM_LUMA);
    a->fineness = gsf_colour_fineness(&a->steps, splat->major, splat->aspect);
    code_luma(coder, a, splat);
    gsf_coder_count_in(coder, GSF_STREAM_CHROMA);
    if (a->header.has_chroma)
        code_chroma(coder, a, splat);
    gsf_coder_count_in(coder, GSF_STREAM_ALPHA);
    if (a->header.has_alpha)
        splat->alpha = code_from(coder, &a->alpha, a->alpha_min, splat->alpha);
    gsf_coder_count_in(coder, GSF_STREAM_OPACITY);
    if (a->header.has_opacity)
        splat->opacity = (uint16_t)gsf_code_with_model(coder, splat->opacity, &a->opacity);
    gsf_coder_count_in(coder, GSF_STREAM_TEXTURE);
    if (a->header.has_texture)
        code_texture(coder, a, splat);
}
