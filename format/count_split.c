#include "format/count_split.h"

#define MAX_TABLE 255u    /* of larger n only the leading bits are coded with the distribution */
#define MAX_WEIGHT 65535u /* keeps every product below 2^64 */
#define MODE_WEIGHT (UINT64_C(1) << 32)

/* The distribution of the left count; its parameters are in units of 1/GSF_WEIGHT_UNIT. */
typedef struct beta_binomial {
    uint64_t n, left, right;
} beta_binomial;

/* P(k + 1) / P(k) = numerator / denominator:
 *     (n - k) (left + k)  /  (k + 1) (right + n - 1 - k) */
static uint64_t numerator(const beta_binomial *b, uint64_t k) {
    return (b->n - k) * (b->left + GSF_WEIGHT_UNIT * k);
}

static uint64_t denominator(const beta_binomial *b, uint64_t k) {
    return (k + 1) * (b->right + GSF_WEIGHT_UNIT * (b->n - 1 - k));
}

/* The most likely count: numerator - denominator is linear in k and changes sign there. */
static uint32_t mode_of(const beta_binomial *b) {
    const int64_t unit = GSF_WEIGHT_UNIT, n = (int64_t)b->n;
    const int64_t left = (int64_t)b->left - unit, right = (int64_t)b->right - unit;
    const int64_t excess = n * left - right, slope = left + right;
    if (excess <= 0)
        return 0;
    if (slope <= 0 || excess >= n * slope)
        return (uint32_t)n;
    return (uint32_t)((excess + slope - 1) / slope);
}

/* Computes the frequencies of 0..n; returns their sum. */
static uint32_t fill_table(const beta_binomial *b, uint16_t *freq) {
    uint64_t weight[MAX_TABLE + 1], sum = MODE_WEIGHT;
    const uint32_t n = (uint32_t)b->n, mode = mode_of(b);
    weight[mode] = MODE_WEIGHT;
    for (uint32_t k = mode; k < n; k++)
        sum += weight[k + 1] = weight[k] * numerator(b, k) / denominator(b, k);
    for (uint32_t k = mode; k > 0; k--)
        sum += weight[k - 1] = weight[k] * denominator(b, k - 1) / numerator(b, k - 1);

    uint32_t total = 0;
    for (uint32_t k = 0; k <= n; k++) {
        freq[k] = (uint16_t)(1 + weight[k] * (GSF_MAX_TOTAL - 1 - n) / sum);
        total += freq[k];
    }
    return total;
}

/* Halves the weights until both are at most MAX_WEIGHT. */
static beta_binomial distribution_of(uint32_t n, uint32_t left_weight, uint32_t right_weight) {
    while (left_weight > MAX_WEIGHT || right_weight > MAX_WEIGHT) {
        left_weight = (left_weight + 1) / 2;
        right_weight = (right_weight + 1) / 2;
    }
    return (beta_binomial){n, left_weight, right_weight};
}

/* Returns the frequencies that fill_table computes for n = 1.  The more likely half has MODE_WEIGHT. */
gsf_single_split gsf_single_split_of(uint32_t left_weight, uint32_t right_weight) {
    const beta_binomial b = distribution_of(1, left_weight, right_weight);
    const bool left = b.left > b.right;
    const uint64_t less = left ? MODE_WEIGHT * b.right / b.left : MODE_WEIGHT * b.left / b.right;
    const uint64_t sum = MODE_WEIGHT + less, shared = MODE_WEIGHT * (GSF_MAX_TOTAL - 2), larger = shared / sum;
    const bool inexact = larger * sum != shared;
    const uint32_t smaller = (uint32_t)(GSF_MAX_TOTAL - 2 - larger - inexact); /* both are rounded down */
    return (gsf_single_split){1 + (left ? smaller : (uint32_t)larger), GSF_MAX_TOTAL - inexact};
}

bool gsf_code_single_split(gsf_coder *coder, bool left, gsf_single_split split) {
    return gsf_code_binary(coder, left, split.right, split.total) != 0;
}

uint32_t gsf_code_count_split(gsf_coder *coder, uint32_t left, uint32_t n, uint32_t left_weight,
                              uint32_t right_weight) {
    unsigned shift = 0; /* low bits of the count, which are coded with equal frequencies */
    while (n >> shift > MAX_TABLE)
        shift++;
    if (n == 1 && !GSF_IS_SMALL)
        return gsf_code_single_split(coder, left != 0, gsf_single_split_of(left_weight, right_weight));
    const beta_binomial b = distribution_of(n >> shift, left_weight, right_weight);
    uint16_t freq[MAX_TABLE + 1];
    const uint32_t total = fill_table(&b, freq);
    const uint32_t base = gsf_code_symbol(coder, left >> shift, freq, (n >> shift) + 1, total) << shift;
    if (shift == 0)
        return base;
    const uint32_t available = n - base + 1; /* counts from base to n */
    const uint32_t low_values = available >> shift != 0 ? UINT32_C(1) << shift : available;
    return base + gsf_code_uniform(coder, left - base, low_values);
}
