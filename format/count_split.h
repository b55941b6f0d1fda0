/* Beta-binomial coding of counts (FORMAT.md, "Count splits"): how many of n points are in the left of two halves. */
#ifndef GSCL_FORMAT_COUNT_SPLIT_H
#define GSCL_FORMAT_COUNT_SPLIT_H

#include "format/coder.h"

#define GSF_WEIGHT_UNIT 64u /* the weight of a half that stands for a distribution parameter of 1 */

/* Codes a count left <= n <= 2^20.  The weights of the halves are the two parameters of the beta-binomial distribution
 * in 1/GSF_WEIGHT_UNIT, each at least 1 and below 2^31.  With n > 1 at least one must be GSF_WEIGHT_UNIT or more, so
 * that the distribution has a single mode. */
uint32_t gsf_code_count_split(gsf_coder *coder, uint32_t left, uint32_t n, uint32_t left_weight, uint32_t right_weight);

/* The split of a single point, the most frequent case: the same as gsf_code_count_split with n = 1, with the
 * frequencies computed in advance. */
typedef struct gsf_single_split {
    uint32_t right, total; /* frequency of the right half, and of both: GSF_MAX_TOTAL or one less */
} gsf_single_split;

gsf_single_split gsf_single_split_of(uint32_t left_weight, uint32_t right_weight);
/* Codes whether the point is in the left half. */
bool gsf_code_single_split(gsf_coder *coder, bool left, gsf_single_split split);

#endif
