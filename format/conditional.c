#include "format/conditional.h"

/* These numbers are part of the format: FORMAT.md, "Conditional models". */
#define START 4u        /* weight of a start value */
#define ROW_REACH 4u    /* rows at this distance and further learn nothing */
#define ROW_LIMIT 4000u /* a row's frequencies are halved when their sum is above this */

void gsf_conditional_init(gsf_conditional *m, const gsf_conditional_shape *shape) {
    m->shape = shape;
    m->descending = false;
    for (uint32_t row = 0; row < shape->rows; row++) {
        uint16_t *freq = m->padded[row] + GSF_REACH;
        m->total[row] = 0;
        for (uint32_t i = 0; i < shape->columns; i++) {
            freq[i] = (uint16_t)(START * shape->table[row * shape->columns + i]);
            m->total[row] += freq[i];
        }
    }
}

static void halve(gsf_conditional *m, uint32_t row) {
    uint16_t *freq = m->padded[row] + GSF_REACH;
    m->total[row] = 0;
    for (uint32_t i = 0; i < m->shape->columns; i++) {
        freq[i] = (uint16_t)((freq[i] + 1) / 2);
        m->total[row] += freq[i];
    }
}

/* The gains of the symbol and its neighbours, from GSF_REACH below it on, and of those among them that exist. */
typedef struct gains {
    uint16_t of[2 * GSF_REACH + 1];
    uint32_t sum;
} gains;

static gains gains_around(const gsf_conditional_shape *shape, uint32_t symbol) {
    gains g = {.sum = 0};
    for (uint32_t i = 0; i < 2 * GSF_REACH + 1; i++) {
        g.of[i] = shape->gain[i < GSF_REACH ? GSF_REACH - i : i - GSF_REACH];
        g.sum += symbol + i >= GSF_REACH && symbol + i - GSF_REACH < shape->columns ? g.of[i] : 0;
    }
    return g;
}

/* Neighbours across the ends of a cyclic row, at distance 1 at most. */
static void add_across(gsf_conditional *m, uint32_t row, uint32_t symbol, uint32_t weight) {
    const uint32_t last = m->shape->columns - 1, gain = weight * m->shape->gain[1];
    if (symbol != 0 && symbol != last)
        return;
    uint16_t *other = &m->padded[row][GSF_REACH + (symbol == 0 ? last : 0)];
    *other = (uint16_t)(*other + gain);
    m->total[row] += gain;
}

void gsf_conditional_update(gsf_conditional *m, uint32_t row, uint32_t symbol) {
    const uint32_t first = row < ROW_REACH - 1 ? 0 : row - (ROW_REACH - 1);
    const uint32_t reached = m->descending ? row + 1 : row + ROW_REACH;
    const uint32_t end = reached < m->shape->rows ? reached : m->shape->rows;
    const gains g = gains_around(m->shape, symbol);
    for (uint32_t r = first; r < end; r++) {
        const uint32_t weight = ROW_REACH - (r < row ? row - r : r - row);
        uint16_t *freq = m->padded[r] + symbol;
        for (uint32_t i = 0; i < 2 * GSF_REACH + 1; i++)
            freq[i] = (uint16_t)(freq[i] + weight * g.of[i]);
        m->total[r] += weight * g.sum;
        if (m->shape->cyclic)
            add_across(m, r, symbol, weight);
        if (m->total[r] > ROW_LIMIT)
            halve(m, r);
    }
}

uint32_t gsf_code_conditional(gsf_coder *coder, uint32_t symbol, gsf_conditional *m, uint32_t row) {
    symbol = gsf_code_symbol(coder, symbol, gsf_conditional_row(m, row), m->shape->columns, m->total[row]);
    gsf_conditional_update(m, row, symbol);
    return symbol;
}

uint32_t gsf_code_conditional_below(gsf_coder *coder, uint32_t symbol, gsf_conditional *m, uint32_t row,
                                    uint32_t count) {
    const uint16_t *freq = gsf_conditional_row(m, row);
    uint32_t total = 0;
    for (uint32_t i = 0; i < count; i++)
        total += freq[i];
    symbol = gsf_code_symbol(coder, symbol, freq, count, total);
    gsf_conditional_update(m, row, symbol);
    return symbol;
}
