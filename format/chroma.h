/* Coding of the two colour differences (FORMAT.md, "Chroma"): a mixture of a plain histogram and one
 * of the distance to what the splats nearby have, weighted by which of them did better so far. */
#ifndef GSCL_FORMAT_CHROMA_H
#define GSCL_FORMAT_CHROMA_H

#include "format/coder.h"
#include "format/model.h"

#define GSF_FIELD_LEVELS 6
#define GSF_FIELD_SIDE (1u << (GSF_FIELD_LEVELS - 1))
#define GSF_FIELD_BUCKETS 1365 /* 1 + 4 + 16 + ... + 32 * 32 */

typedef struct gsf_chroma_channel {
    gsf_model plain, residual;
    uint32_t plain_weight;            /* the rest to 2^16 is the residual's */
    int16_t field[GSF_FIELD_BUCKETS]; /* mean code in a part of the image, in 1/16 */
} gsf_chroma_channel;

typedef struct gsf_chroma {
    int32_t levels; /* codes are -levels..levels */
    gsf_chroma_channel channel[2];
    bool known[GSF_FIELD_BUCKETS]; /* the field has a value */
} gsf_chroma;

void gsf_chroma_init(gsf_chroma *chroma, int32_t levels);

/* Codes co and cg of the splat at (x, y), in a bucket 0..GSF_FIELD_SIDE-1 of the picture each way. */
void gsf_code_chroma(gsf_coder *coder, gsf_chroma *chroma, uint32_t bucket_x, uint32_t bucket_y, int16_t code[2]);

#endif
