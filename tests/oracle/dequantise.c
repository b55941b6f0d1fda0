/* "Dequantisation". */
#include <math.h>

#include "oracle.h"

static const uint64_t T[33] = {16777216, 17144589, 17520007, 17903645, 18295684, 18696307, 19105703, 19524063, 19951585,
                               20388467, 20834917, 21291142, 21757357, 22233781, 22720638, 23218155, 23726566, 24246111,
                               24777031, 25319578, 25874004, 26440571, 27019544, 27611195, 28215802, 28833647, 29465022,
                               30110222, 30769550, 31443315, 32131834, 32835430, 33554432};

static const double pi = 3.14159265358979323846;

static uint64_t sigma_of(const gsf_steps *steps, uint32_t code) {
    const uint32_t e = code * (steps->scale + 4u);
    return e >= 512 ? (uint64_t)1 << 31 : (T[e % 32] << (e / 32)) >> 9;
}

static double position_step(const gsf_steps *steps, uint32_t major) {
    const uint64_t step = sigma_of(steps, major) * (steps->position + 2u) >> 13;
    return step > 8 ? (double)step : 8.0;
}

static double angle_count(const gsf_steps *steps, uint32_t aspect) {
    const uint32_t e = aspect * (steps->scale + 4u);
    if (e >= 256)
        return 512;
    const uint64_t a = T[e % 32] << (e / 32), inverse = T[32 - e % 32] >> (e / 32 + 1);
    const uint64_t product = (a - inverse) * 52707179, divisor = (uint64_t)(steps->angle + 2u) << 44;
    const uint64_t count = product / divisor + (product % divisor != 0);
    return count < 1 ? 1 : count > 512 ? 512 : (double)count;
}

static double part_count(const gsf_steps *steps, uint32_t aspect) {
    const uint32_t e = aspect * (steps->scale + 4u);
    return e >= 512 ? 65536 : (double)(((T[e % 32] << (e / 32)) + (1 << 23)) >> 24);
}

static double levels_of(uint32_t step) {
    static const double levels[16] = {4, 6, 8, 11, 16, 20, 24, 28, 32, 40, 48, 64, 96, 128, 192, 255};
    return levels[step];
}

/* ---- Scalar coding ---- */

static double axis_length(const gsf_steps *steps, uint32_t code) {
    const double e = code * (steps->scale + 4u);
    return fmin(exp2(e / 32.0 - 1.0), 32768.0);
}

static double fineness_of(const gsf_steps *steps, const gsf_splat *codes) {
    static const int finer_from[7] = {-210, -92, -15, 43, 90, 128, 161};
    const int area = (2 * codes->major - codes->aspect - 2 * steps->pivot) * (steps->scale + 4);
    double fineness = 1;
    for (int i = 0; i < 7; i++)
        fineness += area >= finer_from[i];
    return fineness;
}

static void scalar_colour(const gsf_coded_image *coded, const gsf_splat *codes, double *colour) {
    const gsf_header *header = &coded->header;
    const double fineness = fineness_of(&coded->steps, codes);
    const double luma = codes->luma / (levels_of(coded->steps.luma) * fineness);
    if (header->has_chroma) {
        const double levels = levels_of(coded->steps.chroma) * fineness;
        const double co = codes->co / levels, cg = codes->cg / levels;
        const double t = luma - cg / 2.0;
        colour[1] = luma + cg / 2.0;
        colour[2] = t - co / 2.0;
        colour[0] = colour[2] + co;
    } else {
        colour[0] = luma;
    }
    if (header->has_alpha)
        colour[header->has_chroma ? 3 : 1] = codes->alpha / levels_of(coded->steps.alpha);
}

static oracle_splat scalar_splat(const gsf_coded_image *coded, const gsf_splat *codes) {
    const gsf_steps *steps = &coded->steps;
    const double step = position_step(steps, codes->major), parts = part_count(steps, codes->aspect);
    const double quarter_turns = 4.0 * codes->angle / angle_count(steps, codes->aspect); /* quarters of half a turn */
    const bool steep = coded->header.has_rotation && quarter_turns > 1.0 && quarter_turns < 3.0;
    oracle_splat splat = {
        .x = floor((2.0 * codes->x + 1.0) * step / (steep ? parts : 1.0)) / 512.0,
        .y = floor((2.0 * codes->y + 1.0) * step / (steep ? 1.0 : parts)) / 512.0,
        .s1 = axis_length(steps, codes->major),
        .s2 = axis_length(steps, (uint32_t)codes->major - codes->aspect),
        .theta = codes->angle * pi / angle_count(steps, codes->aspect),
        .opacity = coded->header.has_opacity ? (codes->opacity + 1.0) / (steps->opacity + 1.0) : 1.0,
    };
    if (splat.s1 <= 4096.0)
        splat.amplitude = fmin(2.0 * codes->texture.amplitude / (3.0 * levels_of(steps->luma)), 1.0);
    splat.wavelength = 2.5 * exp2(7.0 * codes->texture.wave / 16.0);
    splat.direction = codes->texture.direction * pi / 16.0;
    splat.phase = codes->texture.phase * pi / 4.0;
    scalar_colour(coded, codes, splat.colour);
    return splat;
}

/* ---- Codebook coding ---- */

static double word_value(const gsf_range *range, uint32_t bits, uint32_t code) {
    return range->min + code * (double)(range->max - range->min) / ((1u << bits) - 1u);
}

static oracle_splat codebook_splat(const gsf_coded_image *coded, const gsf_indexed_splat *codes, uint32_t channels) {
    const gsf_header *header = &coded->header;
    const gsf_codebooks *books = &coded->codebooks;
    const uint16_t *shape = books->shape_words[codes->shape], *colour = books->colour_words[codes->colour];
    const double cells = 1u << books->position_bits;
    oracle_splat splat = {
        .x = floor((2.0 * codes->x + 1.0) * header->width * 256.0 / cells) / 512.0,
        .y = floor((2.0 * codes->y + 1.0) * header->height * 256.0 / cells) / 512.0,
        .s1 = exp2(word_value(&books->shape[0], books->shape_bits, shape[0]) / 32.0 - 4.0),
        .opacity = 1.0,
    };
    splat.s2 = splat.s1;
    if (header->has_anisotropy)
        splat.s2 = exp2(word_value(&books->shape[1], books->shape_bits, shape[1]) / 32.0 - 4.0);
    if (header->has_rotation)
        splat.theta = word_value(&books->shape[2], books->shape_bits, shape[2]) * pi / 256.0;
    for (uint32_t i = 0; i < channels; i++)
        splat.colour[i] = word_value(&books->colour[i], books->colour_bits, colour[i]) / 255.0;
    if (header->has_opacity)
        splat.opacity = word_value(&books->colour[channels], books->colour_bits, colour[channels]) / 255.0;
    return splat;
}

static void set_mean_background(oracle_image *image) {
    for (uint32_t k = 0; k < image->header.channels; k++) {
        image->background[k] = 0.0;
        for (uint32_t i = 0; i < image->header.splats; i++)
            image->background[k] += image->splats[i].colour[k] / image->header.splats;
    }
}

void oracle_dequantise(const gsf_coded_image *coded, oracle_image *image) {
    const uint32_t channels = image->header.channels;
    for (uint32_t i = 0; i < channels; i++)
        image->background[i] = coded->background[i] / (coded->header.high_bit_depth ? 65535.0 : 255.0);
    for (uint32_t i = 0; i < coded->header.splat_count; i++) {
        oracle_splat *splat = &image->splats[i];
        *splat = coded->header.coding == GSF_CODING_CODEBOOK ? codebook_splat(coded, &coded->indexed[i], channels)
                                                             : scalar_splat(coded, &coded->splats[i]);
        splat->s1 = fmax(splat->s1, splat->s2 / 256.0);
        splat->s2 = fmax(splat->s2, splat->s1 / 256.0);
    }
    if (coded->has_mean_background)
        set_mean_background(image);
}
