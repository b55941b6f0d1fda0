/* Coding of the two colour differences (FORMAT.md, "Chroma").  The frequencies are a mixture of two adaptive models:
 * one of the code itself, one of its difference from the mean of the splats nearby.  The weights of the mixture follow
 * the probability that each model gave to the codes so far. */
#ifndef GSCL_FORMAT_CHROMA_H
#define GSCL_FORMAT_CHROMA_H

#include "format/coder.h"
#include "format/model.h"

/* The image is divided into 2^l x 2^l buckets at level l. */
#define GSF_PYRAMID_LEVELS 6
#define GSF_PYRAMID_SIDE (1u << (GSF_PYRAMID_LEVELS - 1))
#define GSF_PYRAMID_BUCKETS 1365 /* 1 + 4 + 16 + ... + 32 * 32 */

#define GSF_MAX_CHROMA_CODES 511      /* -255..255 */
#define GSF_MAX_CHROMA_RESIDUALS 1021 /* -510..510 */

typedef struct gsf_chroma_channel {
    gsf_model plain, residual;
    uint16_t plain_freq[GSF_MAX_CHROMA_CODES], residual_freq[GSF_MAX_CHROMA_RESIDUALS];
    uint32_t plain_weight;                /* of 2^16; the residual model has 2^16 - plain_weight */
    uint16_t mixed[GSF_MAX_CHROMA_CODES]; /* frequencies that coded the last code, and their sum */
    uint32_t mixed_total;
    int16_t mean[GSF_PYRAMID_BUCKETS]; /* mean code of the splats in a bucket, in 1/16 */
} gsf_chroma_channel;

typedef struct gsf_chroma {
    int32_t levels; /* codes are -levels..levels */
    gsf_chroma_channel channel[2];
    int64_t co_co, co_cg;             /* sums of products of the differences of codes from the means nearby, in 1/256 */
    bool filled[GSF_PYRAMID_BUCKETS]; /* the bucket has a mean */
} gsf_chroma;

void gsf_chroma_init(gsf_chroma *chroma, int32_t levels);

/* Codes Co and Cg of a splat whose centre is in the given bucket of the finest level, 0..GSF_PYRAMID_SIDE-1 along each
 * axis. */
void gsf_code_chroma(gsf_coder *coder, gsf_chroma *chroma, uint32_t bucket_x, uint32_t bucket_y, int16_t code[2]);

#endif
