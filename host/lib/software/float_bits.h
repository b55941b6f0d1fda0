/* Bounds and roundings of floats by their bits.  Compilers make vectors of these; comparisons of floats, which may trap, stop
 * them. */
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
    v.bits = (int32_t)v.bits > 0 ? v.bits : 0;
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

/* The integer that is nearest to x, |x| < 2^22.  A float of 1.5 * 2^23 and more has no bits after the point, so that the sum
 * is rounded.  It is read as bits, because on some machines a value in a register has more of them (FLT_EVAL_METHOD 1 and
 * 2), with clang for i386 also where C99 has it rounded. */
static inline float gscl_nearest_integer(float x) {
    const gscl_float_bits sum = {x + 12582912.0f};
    return (float)((int32_t)sum.bits - 0x4B400000);
}

#endif
