/* Elementary functions in double precision whose results have the same bits on every machine.
 *
 * A C library chooses other instructions on other processors, and other systems have other C libraries, so that the last
 * bit of exp(x) differs.  Where the bytes of a file can depend on such a function, the library calls these.  They use only
 * operations that IEEE 754 defines exactly: + - * / and sqrt, rounded to nearest, and none is fused.  Only processors that
 * compute doubles with more bits (FLT_EVAL_METHOD 2) give others.
 *
 * Unless stated otherwise the relative error is at most 6e-16, arguments may be any numbers, and results at infinities and
 * beyond the range of doubles are those of C99, without errno and floating-point exceptions.  NaN gives NaN.  In single
 * precision callers round the result.
 *
 * With GSCL_SINGLE_PRECISION (real.h) there are only those functions of gscl_real, as elementary_single.c describes them. */
#ifndef GSCL_LIB_ELEMENTARY_H
#define GSCL_LIB_ELEMENTARY_H

#include "runtime/real.h"

/* Exponential functions to the bases e and 2. */
gscl_real gscl_exp(gscl_real x);
gscl_real gscl_exp2(gscl_real x);

/* Logarithms to the bases e, 2 and 10: -INFINITY at 0 of either sign, NaN below. */
gscl_real gscl_ln(gscl_real x);
double gscl_log2(double x);
double gscl_log10(double x);

/* x^y for x >= 0: exp(y ln x), with a relative error of at most 6e-16 (1 + |y ln x|); NaN for x < 0 unless y = 0. */
double gscl_pow(double x, double y);

double gscl_cbrt(double x);

/* Angles in radians.  Beyond |x| = 1e6, which no caller needs, results are numbers in the right range, but not accurate;
 * NaN at infinities; results that are 0 may have lost their sign.  The error of the tangent is at most 1e-15. */
gscl_real gscl_sin(gscl_real x);
gscl_real gscl_cos(gscl_real x);
double gscl_tan(double x);

/* The angle of the vector (x, y) in -pi..pi, with the signs of zeros as in C99. */
gscl_real gscl_atan2(gscl_real y, gscl_real x);

/* The length of the vector (x, y), without overflow or underflow of squares. */
gscl_real gscl_hypot(gscl_real x, gscl_real y);

/* log2(n!) = log2(gamma(n + 1)) for any real n >= 0: the error is at most 6e-16 of the result, plus 5e-14. */
double gscl_log2_factorial(double n);

#endif
