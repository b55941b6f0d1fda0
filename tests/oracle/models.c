/* "Adaptive models" and "Count splits". */
#include "parts.h"

typedef struct {
    uint32_t base, height, width, gain[3], mean_limit;
} model_shape;

static const model_shape shapes[] = {
    [ORACLE_MODEL_ASPECT] = {2, 40, 4, {32, 24, 12}, 96},
    [ORACLE_MODEL_DIRECTION] = {64, 0, 1, {16, 6, 0}, 256},
    [ORACLE_MODEL_LUMA] = {8, 0, 1, {32, 20, 10}, 192},
    [ORACLE_MODEL_ALPHA] = {4, 0, 1, {32, 8, 2}, 256},
    [ORACLE_MODEL_OPACITY] = {16, 0, 1, {32, 8, 0}, 256},
    [ORACLE_MODEL_TEXTURED] = {64, 0, 1, {24, 0, 0}, 1024},
    [ORACLE_MODEL_AMPLITUDE] = {2, 40, 2, {32, 12, 4}, 192},
    [ORACLE_MODEL_WAVE] = {12, 0, 1, {24, 10, 0}, 192},
    [ORACLE_MODEL_WAVE_DIRECTION] = {64, 0, 1, {16, 6, 0}, 256},
    [ORACLE_MODEL_PLAIN_CHROMA] = {1, 80, 2, {64, 6, 0}, 192},
    [ORACLE_MODEL_RESIDUAL_CHROMA] = {1, 100, 2, {64, 14, 3}, 128},
    [ORACLE_MODEL_COLOUR_INDEX] = {16, 0, 1, {32, 4, 0}, 256},
};

void oracle_model_init(oracle_model *model, oracle_model_kind kind, uint32_t count, uint32_t centre) {
    const model_shape *shape = &shapes[kind];
    const int64_t square = (int64_t)shape->width * shape->width;
    model->count = count;
    model->limit = count * shape->mean_limit < 32000 ? count * shape->mean_limit : 32000;
    for (int i = 0; i < 3; i++)
        model->gain[i] = shape->gain[i];
    for (uint32_t i = 0; i < count; i++) {
        const int64_t d = (int64_t)i - centre;
        model->f[i] = shape->base + (uint32_t)(shape->height * square / (square + d * d));
    }
}

static uint32_t sum_of(const uint32_t *f, uint32_t count) {
    uint32_t sum = 0;
    for (uint32_t i = 0; i < count; i++)
        sum += f[i];
    return sum;
}

void oracle_model_add(oracle_model *model, int64_t symbol, uint32_t amount) {
    if (symbol >= 0 && symbol < (int64_t)model->count)
        model->f[symbol] += amount;
}

void oracle_model_update(oracle_model *model, uint32_t symbol) {
    oracle_model_add(model, symbol, model->gain[0]);
    for (int64_t away = 1; away <= 2; away++) {
        oracle_model_add(model, symbol - away, model->gain[away]);
        oracle_model_add(model, symbol + away, model->gain[away]);
    }
    while (sum_of(model->f, model->count) > model->limit) {
        for (uint32_t i = 0; i < model->count; i++)
            model->f[i] = (model->f[i] + 1) / 2;
    }
}

uint32_t oracle_model_decode(oracle_model *model, oracle_decoder *decoder) {
    const uint32_t symbol = oracle_symbol(decoder, model->f, model->count);
    oracle_model_update(model, symbol);
    return symbol;
}

/* ---- Count splits ---- */

#define MAX_TABLE 255

typedef struct {
    int64_t m, left, right;
} distribution;

static uint64_t numerator(const distribution *d, int64_t k) {
    return (uint64_t)((d->m - k) * (d->left + 64 * k));
}

static uint64_t denominator(const distribution *d, int64_t k) {
    return (uint64_t)((k + 1) * (d->right + 64 * (d->m - 1 - k)));
}

static int64_t mode_of(const distribution *d) {
    const int64_t excess = d->m * (d->left - 64) - (d->right - 64);
    const int64_t slope = d->left - 64 + d->right - 64;
    if (excess <= 0)
        return 0;
    if (slope <= 0 || excess >= d->m * slope)
        return d->m;
    return (excess + slope - 1) / slope;
}

static void split_frequencies(const distribution *d, uint32_t *f) {
    uint64_t w[MAX_TABLE + 1], sum = 0;
    const int64_t mode = mode_of(d);
    w[mode] = (uint64_t)1 << 32;
    for (int64_t k = mode; k < d->m; k++)
        w[k + 1] = w[k] * numerator(d, k) / denominator(d, k);
    for (int64_t k = mode; k > 0; k--)
        w[k - 1] = w[k] * denominator(d, k - 1) / numerator(d, k - 1);
    for (int64_t k = 0; k <= d->m; k++)
        sum += w[k];
    for (int64_t k = 0; k <= d->m; k++)
        f[k] = (uint32_t)(1 + w[k] * (uint64_t)(65535 - d->m) / sum);
}

uint32_t oracle_count_split(oracle_decoder *decoder, uint32_t n, uint64_t left_weight, uint64_t right_weight) {
    uint32_t shift = 0;
    while (n >> shift > MAX_TABLE)
        shift++;
    while (left_weight > 65535 || right_weight > 65535) {
        left_weight = (left_weight + 1) / 2;
        right_weight = (right_weight + 1) / 2;
    }
    const distribution d = {n >> shift, (int64_t)left_weight, (int64_t)right_weight};
    uint32_t f[MAX_TABLE + 1];
    split_frequencies(&d, f);
    uint32_t left = oracle_symbol(decoder, f, (uint32_t)d.m + 1) << shift;
    if (shift > 0) {
        const uint32_t available = n - left + 1;
        left += oracle_uniform(decoder, available < 1u << shift ? available : 1u << shift);
    }
    return left;
}
