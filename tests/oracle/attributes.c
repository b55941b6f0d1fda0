/* "Attributes" of the payload, scalar coding. */
#include <stdlib.h>

#include "parts.h"

#define BINS 16
#define LEVELS 6

/* ---- Angle ---- */

/* ceil(count * (2 b - 1) / 32) */
static int32_t bin_start(int32_t count, int32_t bin) {
    const int32_t scaled = count * (2 * bin - 1);
    return scaled <= 0 ? -(-scaled / 32) : (scaled + 31) / 32;
}

/* Bins 0 and 15 are neighbours. */
static void update_bin(oracle_model *directions, uint32_t bin) {
    oracle_model_update(directions, bin);
    if (bin == 0)
        oracle_model_add(directions, 15, 6);
    if (bin == 15)
        oracle_model_add(directions, 0, 6);
}

static uint32_t read_angle(oracle_decoder *decoder, oracle_model *directions, int32_t count) {
    const uint32_t per = ((uint32_t)count + BINS - 1) / BINS;
    uint32_t f[BINS];
    for (int32_t b = 0; b < BINS; b++) {
        const uint32_t codes = (uint32_t)(bin_start(count, b + 1) - bin_start(count, b));
        f[b] = codes == 0 ? 0 : 1 + directions->f[b] * codes / per;
    }
    const int32_t bin = (int32_t)oracle_symbol(decoder, f, BINS);
    const int32_t codes = bin_start(count, bin + 1) - bin_start(count, bin);
    const int32_t within = (int32_t)oracle_uniform(decoder, (uint32_t)codes);
    update_bin(directions, (uint32_t)bin);
    return (uint32_t)((bin_start(count, bin) + within + count) % count);
}

/* ---- Chroma ---- */

typedef struct {
    bool filled;
    int32_t mean[2];
} bucket;

typedef struct {
    oracle_model plain, residual;
    uint64_t weight;
} chroma_channel;

typedef struct {
    int32_t levels; /* L */
    chroma_channel channel[2];
    bucket buckets[LEVELS][32 * 32];
} chroma_coder;

static void chroma_init(chroma_coder *chroma, int32_t levels) {
    chroma->levels = levels;
    const uint32_t l = (uint32_t)levels;
    for (int i = 0; i < 2; i++) {
        oracle_model_init(&chroma->channel[i].plain, ORACLE_MODEL_PLAIN_CHROMA, 2 * l + 1, l);
        oracle_model_init(&chroma->channel[i].residual, ORACLE_MODEL_RESIDUAL_CHROMA, 4 * l + 1, 2 * l);
        chroma->channel[i].weight = 40000;
    }
}

static bucket *bucket_of(chroma_coder *chroma, uint32_t level, uint32_t bx, uint32_t by) {
    const uint32_t shift = LEVELS - 1 - level;
    return &chroma->buckets[level][(by >> shift) * 32 + (bx >> shift)];
}

static uint32_t bucket_index(uint32_t cell, uint32_t step, uint32_t dimension) {
    const uint64_t index = (2 * (uint64_t)cell + 1) * step * 32 / (512 * (uint64_t)dimension);
    return index < 31 ? (uint32_t)index : 31;
}

static int32_t floor_sixteenth(int32_t value) {
    return value >= 0 ? value / 16 : -((-value + 15) / 16);
}

static int32_t read_chroma_code(oracle_decoder *decoder, chroma_channel *channel, int32_t levels, int32_t around) {
    const uint32_t symbols = 2 * (uint32_t)levels + 1;
    const uint32_t *p = channel->plain.f, *r = channel->residual.f + (levels - around);
    uint64_t plain_sum = 0, residual_sum = 0;
    for (uint32_t i = 0; i < symbols; i++) {
        plain_sum += p[i];
        residual_sum += r[i];
    }
    const uint64_t u = channel->weight * 16384 / plain_sum, v = (65536 - channel->weight) * 16384 / residual_sum;
    uint32_t f[ORACLE_MAX_SYMBOLS];
    for (uint32_t i = 0; i < symbols; i++)
        f[i] = (uint32_t)(1 + ((p[i] * u + r[i] * v) >> 15));
    const uint32_t i = oracle_symbol(decoder, f, symbols);

    const uint64_t a = (uint64_t)p[i] * 16384 / plain_sum + 1, b = (uint64_t)r[i] * 16384 / residual_sum + 1;
    uint64_t weight = channel->weight;
    weight = weight * a * 65536 / (weight * a + (65536 - weight) * b);
    channel->weight = weight < 2048 ? 2048 : weight > 63488 ? 63488 : weight;
    oracle_model_update(&channel->plain, i);
    oracle_model_update(&channel->residual, (uint32_t)(levels - around) + i);
    return (int32_t)i - levels;
}

static void read_chroma(oracle_decoder *decoder, chroma_coder *chroma, uint32_t bx, uint32_t by, int32_t code[2]) {
    bucket mean = {false, {0, 0}};
    for (uint32_t level = 0; level < LEVELS; level++) {
        const bucket *here = bucket_of(chroma, level, bx, by);
        if (here->filled)
            mean = *here;
    }
    for (int i = 0; i < 2; i++) {
        const int32_t around = mean.filled ? floor_sixteenth(mean.mean[i] + 8) : 0;
        code[i] = read_chroma_code(decoder, &chroma->channel[i], chroma->levels, around);
    }
    for (uint32_t level = 0; level < LEVELS; level++) {
        bucket *here = bucket_of(chroma, level, bx, by);
        for (int i = 0; i < 2; i++) {
            if (here->filled)
                here->mean[i] += (16 * code[i] - here->mean[i]) / 3;
            else
                here->mean[i] = 16 * code[i];
        }
        here->filled = true;
    }
}

/* ---- All of a splat ---- */

typedef struct {
    oracle_model aspect, direction, luma, alpha, opacity, textured, amplitude, wave, wave_direction;
    chroma_coder chroma;
    int32_t luma_min, alpha_min;
} attribute_coder;

static void attributes_init(attribute_coder *coder, const oracle_payload *payload) {
    const oracle_steps *steps = &payload->steps;
    const int32_t luma = oracle_levels(steps->luma), alpha = oracle_levels(steps->alpha);
    coder->luma_min = oracle_luma_min(payload->header.blend, luma);
    coder->alpha_min = oracle_luma_min(payload->header.blend, alpha);
    oracle_model_init(&coder->aspect, ORACLE_MODEL_ASPECT, 64, 4);
    oracle_model_init(&coder->direction, ORACLE_MODEL_DIRECTION, BINS, 0);
    oracle_model_init(&coder->luma, ORACLE_MODEL_LUMA, (uint32_t)(oracle_luma_max(luma) - coder->luma_min + 1), 0);
    oracle_model_init(&coder->alpha, ORACLE_MODEL_ALPHA, (uint32_t)(oracle_luma_max(alpha) - coder->alpha_min + 1), 0);
    oracle_model_init(&coder->opacity, ORACLE_MODEL_OPACITY, steps->opacity + 1, 0);
    oracle_model_init(&coder->textured, ORACLE_MODEL_TEXTURED, 2, 0);
    oracle_model_init(&coder->amplitude, ORACLE_MODEL_AMPLITUDE, 16, 0);
    oracle_model_init(&coder->wave, ORACLE_MODEL_WAVE, 16, 0);
    oracle_model_init(&coder->wave_direction, ORACLE_MODEL_WAVE_DIRECTION, BINS, 0);
    chroma_init(&coder->chroma, oracle_levels(steps->chroma));
}

static void read_texture(oracle_decoder *decoder, attribute_coder *coder, oracle_codes *splat) {
    if (oracle_model_decode(&coder->textured, decoder) == 0)
        return;
    splat->amplitude = 1 + oracle_model_decode(&coder->amplitude, decoder);
    splat->wave = oracle_model_decode(&coder->wave, decoder);
    splat->wave_direction = oracle_symbol(decoder, coder->wave_direction.f, BINS);
    update_bin(&coder->wave_direction, splat->wave_direction);
    splat->phase = oracle_uniform(decoder, 8);
}

static void read_splat(oracle_payload *payload, attribute_coder *coder, oracle_codes *splat) {
    const oracle_header *header = &payload->header;
    oracle_decoder *decoder = &payload->decoder;
    if (header->has_anisotropy)
        splat->aspect = oracle_model_decode(&coder->aspect, decoder);
    const uint32_t angles = oracle_angle_count(&payload->steps, splat->aspect);
    if (header->has_rotation && angles > 1)
        splat->angle = read_angle(decoder, &coder->direction, (int32_t)angles);
    splat->luma = coder->luma_min + (int32_t)oracle_model_decode(&coder->luma, decoder);
    if (header->has_chroma) {
        const uint32_t step = oracle_step(&payload->steps, oracle_minor(splat->class));
        read_chroma(decoder, &coder->chroma, bucket_index(splat->cell.x, step, header->width),
                    bucket_index(splat->cell.y, step, header->height), splat->chroma);
    }
    if (header->has_alpha)
        splat->alpha = coder->alpha_min + (int32_t)oracle_model_decode(&coder->alpha, decoder);
    if (header->has_opacity)
        splat->opacity = oracle_model_decode(&coder->opacity, decoder);
    if (header->has_texture)
        read_texture(decoder, coder, splat);
}

bool oracle_read_attributes(oracle_payload *payload) {
    attribute_coder *coder = calloc(1, sizeof *coder);
    if (!coder)
        return false;
    attributes_init(coder, payload);
    for (uint32_t i = 0; i < payload->header.splats && !oracle_decoder_failed(&payload->decoder); i++)
        read_splat(payload, coder, &payload->splats[i]);
    free(coder);
    return true;
}
