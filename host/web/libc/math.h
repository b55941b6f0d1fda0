/* Instructions of the processor where it has them, else the functions of JavaScript's Math, which engines call as quickly
 * as their own. */
#ifndef GSCL_WEB_MATH_H
#define GSCL_WEB_MATH_H

/* Names of their own, because the linker would replace those of the C library. */
#define FROM_JAVASCRIPT(name) __attribute__((import_module("Math"), import_name(name)))
FROM_JAVASCRIPT("exp") double math_exp(double x);
FROM_JAVASCRIPT("log") double math_log(double x);
FROM_JAVASCRIPT("pow") double math_pow(double x, double y);
FROM_JAVASCRIPT("cos") double math_cos(double x);
FROM_JAVASCRIPT("sin") double math_sin(double x);
FROM_JAVASCRIPT("tan") double math_tan(double x);
FROM_JAVASCRIPT("atan2") double math_atan2(double y, double x);
#define exp math_exp
#define log math_log
#define log2(x) (math_log(x) / math_log(2))
#define exp2(x) math_pow(2, x)
#define cos math_cos
#define sin math_sin
#define tan math_tan
#define atan2 math_atan2
#define hypot(x, y) __builtin_sqrt((x) * (x) + (y) * (y))

#define INFINITY __builtin_inff()
#define isfinite __builtin_isfinite
#define isnan __builtin_isnan
#define sqrt __builtin_sqrt
#define floor __builtin_floor
#define ceil __builtin_ceil
#define fabs __builtin_fabs
#define fabsf __builtin_fabsf
#define rint __builtin_rint
#define lrint(x) ((long)__builtin_rint(x))
/* Without NaN, which nothing here passes. */
static inline double fmin(double a, double b) {
    return a < b ? a : b;
}
static inline double fmax(double a, double b) {
    return a > b ? a : b;
}
static inline double fmod(double a, double b) {
    return a - b * __builtin_trunc(a / b);
}

#endif
