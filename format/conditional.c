#include "format/conditional.h"

/* These numbers are part of the format: FORMAT.md, "Conditional models". */
#define START 4u        /* weight of a start value */
#define REACH 4u        /* rows at this distance and further learn nothing */
#define ROW_LIMIT 4000u /* a row's frequencies are halved when their sum is above this */

void gsf_conditional_init(gsf_conditional *m, const gsf_conditional_shape *shape) {
    m->shape = shape;
    for (uint32_t row = 0; row < shape->rows; row++) {
        m->total[row] = 0;
        for (uint32_t i = 0; i < shape->columns; i++) {
            m->freq[row][i] = (uint16_t)(START * shape->table[row * shape->columns + i]);
            m->total[row] += m->freq[row][i];
        }
    }
}

static void add(gsf_conditional *m, uint32_t row, uint32_t symbol, uint32_t gain) {
    const uint32_t columns = m->shape->columns;
    if (symbol >= columns) { /* also what wrapped around below zero */
        if (!m->shape->cyclic)
            return;
        symbol = (symbol + columns) % columns;
    }
    m->freq[row][symbol] = (uint16_t)(m->freq[row][symbol] + gain);
    m->total[row] += gain;
}

static void halve(gsf_conditional *m, uint32_t row) {
    m->total[row] = 0;
    for (uint32_t i = 0; i < m->shape->columns; i++) {
        m->freq[row][i] = (uint16_t)((m->freq[row][i] + 1) / 2);
        m->total[row] += m->freq[row][i];
    }
}

void gsf_conditional_update(gsf_conditional *m, uint32_t row, uint32_t symbol) {
    const uint32_t first = row < REACH - 1 ? 0 : row - (REACH - 1);
    const uint32_t end = row + REACH < m->shape->rows ? row + REACH : m->shape->rows;
    for (uint32_t r = first; r < end; r++) {
        const uint32_t weight = REACH - (r < row ? row - r : r - row);
        add(m, r, symbol, weight * m->shape->gain[0]);
        for (uint32_t distance = 1; distance < 3; distance++) {
            const uint32_t gain = weight * m->shape->gain[distance];
            if (gain == 0)
                continue;
            add(m, r, symbol - distance, gain);
            add(m, r, symbol + distance, gain);
        }
        if (m->total[r] > ROW_LIMIT)
            halve(m, r);
    }
}

uint32_t gsf_code_conditional(gsf_coder *coder, uint32_t symbol, gsf_conditional *m, uint32_t row) {
    symbol = gsf_code_symbol(coder, symbol, m->freq[row], m->shape->columns, m->total[row]);
    gsf_conditional_update(m, row, symbol);
    return symbol;
}

uint32_t gsf_code_conditional_below(gsf_coder *coder, uint32_t symbol, gsf_conditional *m, uint32_t row,
                                    uint32_t count) {
    uint32_t total = 0;
    for (uint32_t i = 0; i < count; i++)
        total += m->freq[row][i];
    symbol = gsf_code_symbol(coder, symbol, m->freq[row], count, total);
    gsf_conditional_update(m, row, symbol);
    return symbol;
}
