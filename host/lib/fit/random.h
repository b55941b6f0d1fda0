/* The random generator of fits and benchmarks (cl/random.h), seeded by the caller.
 *
 * K-means (codebook/kmeans.c) has a second generator, xorshift64*, which each run seeds from one number of this one.
 * The number of its draws depends on the data; the sequence here does not.  Another generator there would change the
 * bytes of every file of the paper profile. */
#ifndef GSCL_LIB_RANDOM_H
#define GSCL_LIB_RANDOM_H

#include "cl/random.h"

static inline uint64_t gscl_random(uint64_t *state) {
    return gscl_random_of(*state += GSCL_RANDOM_STEP);
}

/* Goes on as if `draws` numbers had been taken, which a kernel takes (cl/placement.cl). */
static inline void gscl_random_skip(uint64_t *state, uint64_t draws) {
    *state += draws * GSCL_RANDOM_STEP;
}

/* Uniform in [0, 1), 24 bits. */
static inline float gscl_random_unit(uint64_t *state) {
    return gscl_random_unit_of(*state += GSCL_RANDOM_STEP);
}

#endif
