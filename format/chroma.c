#include "format/chroma.h"

#include <string.h>

#define MIX_ONE 65536u

/* These numbers are part of the format: FORMAT.md, "Chroma" and "Adaptive models". */
#define MIN_WEIGHT 2048u    /* of either model, of MIX_ONE */
#define START_WEIGHT 40000u /* of the plain model, of MIX_ONE */
#define MEAN_DIVISOR 3      /* a new splat contributes a third to the mean of its bucket */
#define START_CO_CO 2048    /* keeps the first slopes of Cg against Co small */
static const gsf_model_shape PLAIN = {1, 150, 1, {150, 6, 0}, 600};
static const gsf_model_shape RESIDUAL = {1, 150, 1, {150, 14, 2}, 400};

void gsf_chroma_init(gsf_chroma *chroma, int32_t levels) {
    memset(chroma, 0, sizeof *chroma);
    chroma->levels = levels;
    chroma->co_co = START_CO_CO;
    for (int i = 0; i < 2; i++) {
        gsf_chroma_channel *c = &chroma->channel[i];
        gsf_model_init(&c->plain, &PLAIN, c->plain_freq, 2 * (uint32_t)levels + 1, levels);
        gsf_model_init(&c->residual, &RESIDUAL, c->residual_freq, 4 * (uint32_t)levels + 1, 2 * levels);
        c->plain_weight = START_WEIGHT;
    }
}

/* Level l has 2^l x 2^l buckets, which follow those of the coarser levels. */
static uint32_t bucket_index(unsigned level, uint32_t bucket_x, uint32_t bucket_y) {
    const unsigned shift = GSF_PYRAMID_LEVELS - 1 - level;
    const uint32_t before = ((1u << 2 * level) - 1) / 3;
    return before + ((bucket_y >> shift) << level) + (bucket_x >> shift);
}

/* Index of the finest bucket of the splat that has a mean; -1 when no splat has been coded. */
static int32_t finest_filled(const gsf_chroma *chroma, uint32_t bucket_x, uint32_t bucket_y) {
    for (unsigned level = GSF_PYRAMID_LEVELS; level-- > 0;) {
        const uint32_t index = bucket_index(level, bucket_x, bucket_y);
        if (chroma->filled[index])
            return (int32_t)index;
    }
    return -1;
}

/* The nearest whole code of a number of sixteenths; halves are rounded up. */
static int32_t rounded(int32_t sixteenths) {
    const int32_t positive = 1024; /* makes the division round down */
    return (sixteenths + 8 + 16 * positive) / 16 - positive;
}

static int32_t rounded_in_range(const gsf_chroma *chroma, int64_t sixteenths) {
    const int64_t max = 16 * (int64_t)chroma->levels;
    return rounded((int32_t)(sixteenths < -max ? -max : sixteenths > max ? max : sixteenths));
}

static void update_pyramid(gsf_chroma *chroma, uint32_t bucket_x, uint32_t bucket_y, const int16_t code[2]) {
    for (unsigned level = 0; level < GSF_PYRAMID_LEVELS; level++) {
        const uint32_t index = bucket_index(level, bucket_x, bucket_y);
        for (int i = 0; i < 2; i++) {
            int16_t *mean = &chroma->channel[i].mean[index];
            const int32_t change = 16 * code[i] - *mean;
            *mean = (int16_t)(*mean + (chroma->filled[index] ? change / MEAN_DIVISOR : change));
        }
        chroma->filled[index] = true;
    }
}

static uint32_t sum(const uint16_t *freq, uint32_t count) {
    uint32_t total = 0;
    for (uint32_t i = 0; i < count; i++)
        total += freq[i];
    return total;
}

/* Mixes the frequencies of the two models, scaled to a common total. */
static void mix(gsf_chroma_channel *channel, const uint16_t *residual, uint32_t residual_total) {
    const uint32_t count = channel->plain.count;
    uint32_t total = 0;
    const uint32_t plain_scale = channel->plain_weight * 16384u / channel->plain.total;
    const uint32_t residual_scale = (MIX_ONE - channel->plain_weight) * 16384u / residual_total;
    for (uint32_t i = 0; i < count; i++) { /* at most 2^30: a frequency is no more than its total */
        const uint32_t sum = channel->plain.freq[i] * plain_scale + residual[i] * residual_scale;
        channel->mixed[i] = (uint16_t)(1 + (sum >> 15));
        total += channel->mixed[i];
    }
    channel->mixed_total = total;
}

/* Updates the weight of the plain model by Bayes' rule. */
static void update_weight(gsf_chroma_channel *channel, uint32_t plain, uint32_t residual) {
    const uint64_t for_plain = (uint64_t)channel->plain_weight * plain;
    const uint64_t for_residual = (uint64_t)(MIX_ONE - channel->plain_weight) * residual;
    uint32_t weight = (uint32_t)(for_plain * MIX_ONE / (for_plain + for_residual));
    weight = weight < MIN_WEIGHT ? MIN_WEIGHT : weight;
    channel->plain_weight = weight > MIX_ONE - MIN_WEIGHT ? MIX_ONE - MIN_WEIGHT : weight;
}

static int16_t code_channel(gsf_coder *coder, gsf_chroma_channel *channel, int32_t levels, int32_t predicted,
                            int16_t code) {
    const uint32_t count = channel->plain.count;
    /* The residual of code -levels is -levels - predicted.  Residual 0 is symbol 2 * levels. */
    const uint32_t shift = (uint32_t)(levels - predicted);
    const uint16_t *residual = channel->residual.freq + shift;
    const uint32_t residual_total = sum(residual, count);
    mix(channel, residual, residual_total);
    const uint32_t value =
        gsf_code_symbol(coder, (uint32_t)(code + levels), channel->mixed, count, channel->mixed_total);
    update_weight(channel, channel->plain.freq[value] * 16384u / channel->plain.total + 1,
                  residual[value] * 16384u / residual_total + 1);
    gsf_model_update(&channel->plain, value);
    gsf_model_update(&channel->residual, value + shift);
    return (int16_t)((int32_t)value - levels);
}

void gsf_code_chroma(gsf_coder *coder, gsf_chroma *chroma, uint32_t bucket_x, uint32_t bucket_y, int16_t code[2]) {
    const int32_t index = finest_filled(chroma, bucket_x, bucket_y);
    const int32_t co_mean = index < 0 ? 0 : chroma->channel[0].mean[index];
    const int32_t cg_mean = index < 0 ? 0 : chroma->channel[1].mean[index];
    code[0] = code_channel(coder, &chroma->channel[0], chroma->levels, rounded(co_mean), code[0]);
    const int64_t co_difference = 16 * code[0] - co_mean;
    const int32_t predicted = rounded_in_range(chroma, cg_mean + chroma->co_cg * co_difference / chroma->co_co);
    code[1] = code_channel(coder, &chroma->channel[1], chroma->levels, predicted, code[1]);
    chroma->co_co += co_difference * co_difference;
    chroma->co_cg += co_difference * (16 * code[1] - cg_mean);
    update_pyramid(chroma, bucket_x, bucket_y, code);
}
