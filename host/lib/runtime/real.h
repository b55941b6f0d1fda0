/* The type of the numbers from which a splat's place and shape are computed.
 *
 * It is double, or float in a program that is compiled with GSCL_SINGLE_PRECISION: a decoder for a processor that has
 * instructions for floats only.  Such a program has elementary_single.c in place of elementary.c.  Its pictures are those of
 * doubles within the tolerance of the format (FORMAT.md, "Precision"), and not the same on every machine. */
#ifndef GSCL_LIB_REAL_H
#define GSCL_LIB_REAL_H

#include <math.h>

#ifdef GSCL_SINGLE_PRECISION
typedef float gscl_real;
#define GSCL_OF_REAL(name) name##f
#else
typedef double gscl_real;
#define GSCL_OF_REAL(name) name
#endif

/* A constant. */
#define GSCL_REAL(x) ((gscl_real)(x))

static inline gscl_real gscl_real_sqrt(gscl_real x) {
    return GSCL_OF_REAL(sqrt)(x);
}

static inline gscl_real gscl_real_floor(gscl_real x) {
    return GSCL_OF_REAL(floor)(x);
}

static inline gscl_real gscl_real_ceil(gscl_real x) {
    return GSCL_OF_REAL(ceil)(x);
}

/* The lesser and the larger of two numbers, neither of them NaN. */
static inline gscl_real gscl_real_min(gscl_real x, gscl_real y) {
    return GSCL_OF_REAL(fmin)(x, y);
}

static inline gscl_real gscl_real_max(gscl_real x, gscl_real y) {
    return GSCL_OF_REAL(fmax)(x, y);
}

#endif
