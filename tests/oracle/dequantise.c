/* "Dequantisation" and "Limits". */
#include <math.h>

#include "parts.h"

static const uint64_t T[33] = {16777216, 17144589, 17520007, 17903645, 18295684, 18696307, 19105703, 19524063, 19951585,
                               20388467, 20834917, 21291142, 21757357, 22233781, 22720638, 23218155, 23726566, 24246111,
                               24777031, 25319578, 25874004, 26440571, 27019544, 27611195, 28215802, 28833647, 29465022,
                               30110222, 30769550, 31443315, 32131834, 32835430, 33554432};

static const double pi = 3.14159265358979323846;

uint32_t oracle_minor(uint32_t class) {
    return 63 - class;
}

uint64_t oracle_sigma(const oracle_steps *steps, uint32_t code) {
    const uint32_t e = code * (steps->scale + 4);
    return e >= 512 ? (uint64_t)1 << 31 : (T[e % 32] << (e / 32)) >> 9;
}

uint32_t oracle_step(const oracle_steps *steps, uint32_t minor) {
    const uint64_t step = oracle_sigma(steps, minor) * (steps->position + 2) >> 13;
    return step > 8 ? (uint32_t)step : 8;
}

uint32_t oracle_cells(const oracle_steps *steps, uint32_t minor, uint32_t dimension) {
    const uint32_t step = oracle_step(steps, minor);
    return (dimension * 256 + step - 1) / step;
}

uint32_t oracle_angle_count(const oracle_steps *steps, uint32_t aspect) {
    const uint32_t e = aspect * (steps->scale + 4);
    if (e >= 256)
        return 512;
    const uint64_t a = T[e % 32] << (e / 32), inverse = T[32 - e % 32] >> (e / 32 + 1);
    const uint64_t product = (a - inverse) * 52707179, divisor = (uint64_t)(steps->angle + 2) << 44;
    const uint64_t count = product / divisor + (product % divisor != 0);
    return count < 1 ? 1 : count > 512 ? 512 : (uint32_t)count;
}

int32_t oracle_levels(uint32_t step) {
    static const int32_t levels[16] = {4, 6, 8, 11, 16, 20, 24, 28, 32, 40, 48, 64, 96, 128, 192, 255};
    return levels[step];
}

int32_t oracle_luma_min(oracle_blend blend, int32_t levels) {
    return blend == ORACLE_SUM ? -levels - levels / 8 : -(levels / 8);
}

int32_t oracle_luma_max(int32_t levels) {
    return levels + levels / 8;
}

/* ---- Scalar coding ---- */

static double axis_length(const oracle_steps *steps, uint32_t code) {
    const double e = code * (steps->scale + 4);
    return fmin(exp2(e / 32.0 - 1.0), 32768.0);
}

static void scalar_colour(const oracle_payload *payload, const oracle_codes *codes, double *colour) {
    const oracle_header *header = &payload->header;
    const double luma = (double)codes->luma / oracle_levels(payload->steps.luma);
    if (header->has_chroma) {
        const double levels = oracle_levels(payload->steps.chroma);
        const double co = codes->chroma[0] / levels, cg = codes->chroma[1] / levels;
        const double t = luma - cg / 2.0;
        colour[1] = luma + cg / 2.0;
        colour[2] = t - co / 2.0;
        colour[0] = colour[2] + co;
    } else {
        colour[0] = luma;
    }
    if (header->has_alpha)
        colour[header->colours] = (double)codes->alpha / oracle_levels(payload->steps.alpha);
}

static oracle_splat scalar_splat(const oracle_payload *payload, const oracle_codes *codes) {
    const oracle_steps *steps = &payload->steps;
    const uint32_t minor = oracle_minor(codes->class);
    const double step = oracle_step(steps, minor);
    oracle_splat splat = {
        .x = (codes->cell.x + 0.5) * step / 256.0,
        .y = (codes->cell.y + 0.5) * step / 256.0,
        .s1 = axis_length(steps, minor + codes->aspect),
        .s2 = axis_length(steps, minor),
        .theta = codes->angle * pi / oracle_angle_count(steps, codes->aspect),
        .opacity = payload->header.has_opacity ? (codes->opacity + 1.0) / (steps->opacity + 1.0) : 1.0,
    };
    splat.amplitude = 4.0 * codes->amplitude / (3.0 * oracle_levels(steps->luma));
    splat.wavelength = 2.5 * exp2(7.0 * codes->wave / 16.0);
    splat.direction = codes->wave_direction * pi / 16.0;
    splat.phase = codes->phase * pi / 4.0;
    scalar_colour(payload, codes, splat.colour);
    return splat;
}

/* ---- Codebook coding ---- */

static double word_value(const oracle_codebook *book, uint32_t word, uint32_t dimension) {
    const double range = book->max[dimension] - book->min[dimension];
    return book->min[dimension] + book->codes[word][dimension] * range / ((1u << book->bits) - 1u);
}

static oracle_splat codebook_splat(const oracle_payload *payload, const oracle_codes *codes) {
    const oracle_header *header = &payload->header;
    const oracle_codebooks *books = &payload->books;
    const double cells = 1u << books->position_bits;
    oracle_splat splat = {
        .x = (codes->cell.x + 0.5) / cells * header->width,
        .y = (codes->cell.y + 0.5) / cells * header->height,
        .s1 = exp2(word_value(&books->shapes, codes->class, 0) / 32.0 - 4.0),
        .opacity = 1.0,
    };
    splat.s2 = header->has_anisotropy ? exp2(word_value(&books->shapes, codes->class, 1) / 32.0 - 4.0) : splat.s1;
    if (header->has_rotation)
        splat.theta = word_value(&books->shapes, codes->class, 2) * pi / 256.0;
    for (uint32_t i = 0; i < header->channels; i++)
        splat.colour[i] = word_value(&books->colours, codes->colour_index, i) / 255.0;
    if (header->has_opacity)
        splat.opacity = word_value(&books->colours, codes->colour_index, header->channels) / 255.0;
    return splat;
}

void oracle_dequantise(const oracle_payload *payload, oracle_splat *splats, double *background) {
    const oracle_header *header = &payload->header;
    for (uint32_t i = 0; i < header->channels; i++)
        background[i] = payload->background[i] / (header->high_bit_depth ? 65535.0 : 255.0);
    for (uint32_t i = 0; i < header->splats; i++) {
        const oracle_codes *codes = &payload->splats[i];
        splats[i] = header->codebook ? codebook_splat(payload, codes) : scalar_splat(payload, codes);
    }
}

/* ---- Limits ---- */

/* A length in whole pixels, rounded up. */
static uint64_t scalar_pixels(const oracle_steps *steps, uint32_t code) {
    return (oracle_sigma(steps, code) + 65535) >> 16;
}

static uint64_t word_pixels(const oracle_codebook *book, uint32_t word, uint32_t dimension) {
    const uint64_t m = (1u << book->bits) - 1u, min = (uint64_t)book->min[dimension];
    const uint64_t range = (uint64_t)(book->max[dimension] - book->min[dimension]);
    const uint64_t scaled = min * m + book->codes[word][dimension] * range;
    const uint64_t v = (scaled + m - 1) / m;
    return ((T[v % 32] << (v / 32)) + ((uint64_t)1 << 28) - 1) >> 28;
}

bool oracle_within_limits(const oracle_payload *payload) {
    const oracle_header *header = &payload->header;
    const uint64_t area = (uint64_t)header->width * header->height;
    uint64_t work = 0;
    for (uint32_t i = 0; i < header->splats; i++) {
        const oracle_codes *codes = &payload->splats[i];
        uint64_t s1, s2;
        if (header->codebook) {
            s1 = word_pixels(&payload->books.shapes, codes->class, 0);
            s2 = header->has_anisotropy ? word_pixels(&payload->books.shapes, codes->class, 1) : s1;
        } else {
            const uint32_t minor = oracle_minor(codes->class);
            s1 = scalar_pixels(&payload->steps, minor + codes->aspect);
            s2 = scalar_pixels(&payload->steps, minor);
        }
        const uint64_t cost = 48 * s1 * s2 + 16 * (s1 + s2) + 16;
        work += cost < area ? cost : area;
    }
    return work <= 256 * area + ((uint64_t)1 << 26);
}
