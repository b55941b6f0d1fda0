/* Adaptive frequencies under a condition (FORMAT.md, "Conditional models").  A model has a row of frequencies for each
 * value of the condition, which start from a trained table.  A coded symbol also raises the frequencies of its
 * neighbours, in its own row and, less, in the rows nearby, because an image has only some hundreds of symbols. */
#ifndef GSCL_FORMAT_CONDITIONAL_H
#define GSCL_FORMAT_CONDITIONAL_H

#include "format/coder.h"

#define GSF_MAX_ROWS 24
#define GSF_MAX_COLUMNS 24
#define GSF_REACH 2 /* symbols at this distance also learn */

typedef struct gsf_conditional_shape {
    const uint8_t *table; /* rows * columns start values, each at least 1; a frequency starts at 4 times its value */
    uint32_t rows, columns;
    bool cyclic;      /* the last symbol is a neighbour of the first */
    uint16_t gain[3]; /* added in the symbol's row to the symbol, and to those at distance 1 and 2; times 4 */
} gsf_conditional_shape;

typedef struct gsf_conditional {
    const gsf_conditional_shape *shape;
    bool descending; /* each row asked for is at most the one before: rows above it need not learn */
    uint32_t total[GSF_MAX_ROWS];
    /* Neighbours beyond the ends of a row have places of their own, which are never read. */
    uint16_t padded[GSF_MAX_ROWS][GSF_MAX_COLUMNS + 2 * GSF_REACH];
} gsf_conditional;

void gsf_conditional_init(gsf_conditional *model, const gsf_conditional_shape *shape);
/* The frequencies of a row. */
static inline const uint16_t *gsf_conditional_row(const gsf_conditional *model, uint32_t row) {
    return model->padded[row] + GSF_REACH;
}

/* Adapts the model to a coded symbol. */
void gsf_conditional_update(gsf_conditional *model, uint32_t row, uint32_t symbol);
/* Codes a symbol and adapts the model to it. */
uint32_t gsf_code_conditional(gsf_coder *coder, uint32_t symbol, gsf_conditional *model, uint32_t row);
/* The same where only the first `count` symbols are possible, 1 <= count <= columns. */
uint32_t gsf_code_conditional_below(gsf_coder *coder, uint32_t symbol, gsf_conditional *model, uint32_t row,
                                    uint32_t count);

#endif
