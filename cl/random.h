/* The numbers of the random generator, which the host and the kernels share: SplitMix64 (Steele, Lea and Flood 2014).  Its
 * state grows by GSCL_RANDOM_STEP from number to number, so that each number can be computed without those before. */
#ifndef GSCL_CL_RANDOM_H
#define GSCL_CL_RANDOM_H

#ifdef __OPENCL_VERSION__
typedef ulong gscl_u64;
#define SHARED_FUNCTION
#else
#include <stdint.h>
typedef uint64_t gscl_u64;
#define SHARED_FUNCTION static inline
#endif

#define GSCL_RANDOM_STEP 0x9e3779b97f4a7c15u

/* The number of a state: 64 bits. */
SHARED_FUNCTION gscl_u64 gscl_random_of(gscl_u64 state) {
    state = (state ^ (state >> 30)) * 0xbf58476d1ce4e5b9u;
    state = (state ^ (state >> 27)) * 0x94d049bb133111ebu;
    return state ^ (state >> 31);
}

/* 24 bits of it, and the same as a part of 1. */
SHARED_FUNCTION gscl_u64 gscl_random_bits_of(gscl_u64 state) { return gscl_random_of(state) >> 40; }
SHARED_FUNCTION float gscl_random_unit_of(gscl_u64 state) { return (float)gscl_random_bits_of(state) * 0x1p-24f; }

#endif
