/* Adaptive frequencies of one kind of code (FORMAT.md, "Adaptive models").  A coded symbol also raises the frequencies
 * of its neighbours, because an image has only some hundreds of symbols to adapt to. */
#ifndef GSCL_FORMAT_MODEL_H
#define GSCL_FORMAT_MODEL_H

#include "format/coder.h"

typedef struct gsf_model_shape {
    uint16_t base; /* start: base + height * width^2 / (width^2 + (code - centre)^2) */
    uint16_t height;
    uint16_t width;
    uint16_t gain[3];    /* added to the coded symbol, and to those at distance 1 and 2 */
    uint16_t mean_limit; /* frequencies are halved when their mean is above this; smaller values adapt faster */
} gsf_model_shape;

#define GSF_MODEL_MAX_TOTAL 32000u /* halved above this in any case */

typedef struct gsf_model {
    uint32_t count, total, limit;
    uint16_t gain[3];
    uint16_t *freq; /* of each symbol */
} gsf_model;

/* Symbols 0..count-1, whose frequencies `freq` has room for; the initial ones are highest at `centre`. */
void gsf_model_init(gsf_model *model, const gsf_model_shape *shape, uint16_t *freq, uint32_t count, int32_t centre);
/* Adapts the frequencies to a coded value. */
void gsf_model_update(gsf_model *model, uint32_t value);
/* Adds to the frequency of one value; does nothing when it is outside the alphabet. */
void gsf_model_add(gsf_model *model, uint32_t value, uint16_t gain);
/* Codes a value and adapts the model to it. */
uint32_t gsf_code_with_model(gsf_coder *coder, uint32_t value, gsf_model *model);

#endif
