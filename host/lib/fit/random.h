/* The random generator of fits and benchmarks: SplitMix64 (Steele, Lea and Flood 2014), seeded by the caller.
 *
 * K-means (codebook/kmeans.c) has a second generator, xorshift64*, which each run seeds from one number of this one.
 * The number of its draws depends on the data; the sequence here does not.  Another generator there would change the
 * bytes of every file of the paper profile. */
#ifndef GSCL_LIB_RANDOM_H
#define GSCL_LIB_RANDOM_H

#include <stdint.h>

static inline uint64_t gscl_random(uint64_t *state) {
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* Goes on as if `draws` numbers had been taken, which a kernel takes (cl/placement.cl). */
static inline void gscl_random_skip(uint64_t *state, uint64_t draws) {
    *state += draws * 0x9e3779b97f4a7c15u;
}

/* Uniform in [0, 1), 24 bits. */
static inline float gscl_random_unit(uint64_t *state) {
    return (float)(gscl_random(state) >> 40) * 0x1p-24f;
}

#endif
