/* Instructions of the processor; what it has none for is in elementary.c. */
#ifndef GSCL_WEB_MATH_H
#define GSCL_WEB_MATH_H

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
    return __builtin_wasm_min_f64(a, b);
}
static inline double fmax(double a, double b) {
    return __builtin_wasm_max_f64(a, b);
}
static inline double fmod(double a, double b) {
    return a - b * __builtin_trunc(a / b);
}

#endif
