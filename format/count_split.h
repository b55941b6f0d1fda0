/* Beta-binomial ("Polya urn") coding of counts (FORMAT.md, "Urn splits"): how many of n things are
 * in the left of two halves. */
#ifndef GSCL_FORMAT_COUNT_SPLIT_H
#define GSCL_FORMAT_COUNT_SPLIT_H

#include "format/coder.h"

#define GSF_URN_UNIT 64u /* urn weights are in 1/64 balls */

/* A count left <= n <= 2^20; the halves' weights in GSF_URN_UNITs, each at least 1 and below 2^31.
 * Not both may be below one ball when n > 1: the distribution must have a single peak. */
uint32_t gsf_code_urn(gsf_coder *coder, uint32_t left, uint32_t n, uint32_t left_weight, uint32_t right_weight);

/* One ball, which is what most urns hold: gsf_code_urn with n = 1, for those who code it with the same weights again
 * and again. */
typedef struct gsf_ball {
    uint32_t right, total; /* frequency of the right half, and of both: GSF_MAX_TOTAL or one less */
} gsf_ball;

gsf_ball gsf_ball_of(uint32_t left_weight, uint32_t right_weight);
/* Whether it is in the left half. */
bool gsf_code_ball(gsf_coder *coder, bool left, gsf_ball ball);

#endif
