#include "format/count_split.h"

#define MAX_TABLE 255u    /* larger n are coded by the leading bits of the count */
#define MAX_WEIGHT 65535u /* keeps every product below 2^64 */
#define PEAK (UINT64_C(1) << 32)

typedef struct urn {
    uint64_t n, left, right; /* weights in GSF_URN_UNIT */
} urn;

/* P(k + 1) / P(k) = rise / fall:
 *     (n - k) (left + k)  /  (k + 1) (right + n - 1 - k) */
static uint64_t rise(const urn *u, uint64_t k) {
    return (u->n - k) * (u->left + GSF_URN_UNIT * k);
}

static uint64_t fall(const urn *u, uint64_t k) {
    return (k + 1) * (u->right + GSF_URN_UNIT * (u->n - 1 - k));
}

/* rise - fall is linear in k: the likeliest count is where it changes sign. */
static uint32_t likeliest(const urn *u) {
    const int64_t unit = GSF_URN_UNIT, n = (int64_t)u->n;
    const int64_t left = (int64_t)u->left - unit, right = (int64_t)u->right - unit;
    const int64_t excess = n * left - right, slope = left + right;
    if (excess <= 0)
        return 0;
    if (slope <= 0 || excess >= n * slope)
        return (uint32_t)n;
    return (uint32_t)((excess + slope - 1) / slope);
}

/* Frequencies of 0..n; returns their sum. */
static uint32_t fill_table(const urn *u, uint16_t *freq) {
    uint64_t weight[MAX_TABLE + 1], sum = PEAK;
    const uint32_t n = (uint32_t)u->n, peak = likeliest(u);
    weight[peak] = PEAK;
    for (uint32_t k = peak; k < n; k++)
        sum += weight[k + 1] = weight[k] * rise(u, k) / fall(u, k);
    for (uint32_t k = peak; k > 0; k--)
        sum += weight[k - 1] = weight[k] * fall(u, k - 1) / rise(u, k - 1);

    uint32_t total = 0;
    for (uint32_t k = 0; k <= n; k++) {
        freq[k] = (uint16_t)(1 + weight[k] * (GSF_MAX_TOTAL - 1 - n) / sum);
        total += freq[k];
    }
    return total;
}

/* Weights that products have room for. */
static urn urn_of(uint32_t n, uint32_t left_weight, uint32_t right_weight) {
    while (left_weight > MAX_WEIGHT || right_weight > MAX_WEIGHT) {
        left_weight = (left_weight + 1) / 2;
        right_weight = (right_weight + 1) / 2;
    }
    return (urn){n, left_weight, right_weight};
}

/* What fill_table comes to for one ball.  The likelier side weighs PEAK. */
gsf_ball gsf_ball_of(uint32_t left_weight, uint32_t right_weight) {
    const urn u = urn_of(1, left_weight, right_weight);
    const bool left = u.left > u.right;
    const uint64_t less = left ? PEAK * u.right / u.left : PEAK * u.left / u.right;
    const uint64_t sum = PEAK + less, shared = PEAK * (GSF_MAX_TOTAL - 2), share = shared / sum;
    const bool inexact = share * sum != shared;
    const uint32_t rest = (uint32_t)(GSF_MAX_TOTAL - 2 - share - inexact); /* both are rounded down */
    return (gsf_ball){1 + (left ? rest : (uint32_t)share), GSF_MAX_TOTAL - inexact};
}

bool gsf_code_ball(gsf_coder *coder, bool left, gsf_ball ball) {
    return gsf_code_either(coder, left, ball.right, ball.total) != 0;
}

uint32_t gsf_code_urn(gsf_coder *coder, uint32_t left, uint32_t n, uint32_t left_weight, uint32_t right_weight) {
    unsigned shift = 0; /* low bits of the count that are coded as they are */
    while (n >> shift > MAX_TABLE)
        shift++;
    if (n == 1)
        return gsf_code_ball(coder, left != 0, gsf_ball_of(left_weight, right_weight));
    const urn u = urn_of(n >> shift, left_weight, right_weight);
    uint16_t freq[MAX_TABLE + 1];
    const uint32_t total = fill_table(&u, freq);
    const uint32_t base = gsf_code_symbol(coder, left >> shift, freq, (n >> shift) + 1, total) << shift;
    if (shift == 0)
        return base;
    const uint32_t rest = n - base + 1; /* what the low bits can still be */
    const uint32_t count = rest >> shift != 0 ? UINT32_C(1) << shift : rest;
    return base + gsf_code_uniform(coder, left - base, count);
}
