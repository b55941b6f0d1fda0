/* Bounds on floats by their bits.  Compilers make vectors of these; comparisons of floats, which may trap, stop them. */
#ifndef GSCL_LIB_FLOAT_BITS_H
#define GSCL_LIB_FLOAT_BITS_H

#include <stdint.h>

typedef union gscl_float_bits {
    float value;
    uint32_t bits;
} gscl_float_bits;

/* x, or 0 where x is negative. */
static inline float gscl_positive_part(float x) {
    gscl_float_bits v = {x};
    v.bits &= (v.bits >> 31) - 1u;
    return v.value;
}

/* The lesser and the larger of two floats that are not negative: they are in the order of their bits. */
static inline float gscl_lesser_positive(float x, float y) {
    gscl_float_bits v = {x}, w = {y};
    v.bits = (uint32_t)((int32_t)v.bits < (int32_t)w.bits ? (int32_t)v.bits : (int32_t)w.bits);
    return v.value;
}
static inline float gscl_larger_positive(float x, float y) {
    gscl_float_bits v = {x}, w = {y};
    v.bits = (uint32_t)((int32_t)v.bits > (int32_t)w.bits ? (int32_t)v.bits : (int32_t)w.bits);
    return v.value;
}

#endif
