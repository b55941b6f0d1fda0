/* OpenCL C's built-in functions and work-items for kernels that cl/native.py compiles into the library.
 *
 * A work-group has one work-item here: it is number GSCL_ITEM of a launch, which a kernel gets as its first parameter, and
 * barriers have no work.  Functions are computed with IEEE 754 operations in a fixed order, so that all processors with a
 * fused multiply-add give the same bits; those without one (SOFTWARE_FMA) round twice. */

/* ---- Work-items ---- */

#define __local
#define get_global_id(dimension) GSCL_ITEM
#define get_group_id(dimension) GSCL_ITEM
#define get_local_id(dimension) ((size_t)0)
#define get_local_size(dimension) ((size_t)1)
#define barrier(fences) ((void)0)
#define GROUP_OF(items)

/* The options of the launch that this thread works on (options.h), laid out as gscl_native_options
 * (host/lib/native/programs.h). */
typedef struct {
    int blend, opacity, texture, shape, loss, weighted;
} gscl_native_options;
__attribute__((const)) const gscl_native_options *gscl_launch_options(void);

/* ---- Vectors of one kind ---- */

#define BUILTIN __attribute__((overloadable, always_inline, const))

/* Floats of the processor's vectors that functions can take as arguments. */
#if defined(__AVX512F__)
#define VECTOR_WIDTH 16
#elif defined(__AVX__)
#define VECTOR_WIDTH 8
#elif defined(__SSE4_1__) || defined(__ARM_NEON) || defined(__wasm_simd128__)
#define VECTOR_WIDTH 4
#else
#define VECTOR_WIDTH 1
#endif

/* Instructions of processors: LLVM's intrinsics for a type, which are declared here and are no functions. */
#define INTRINSICS(real, suffix)                                   \
    real gscl_floor_##suffix(real) __asm__("llvm.floor." #suffix); \
    real gscl_ceil_##suffix(real) __asm__("llvm.ceil." #suffix);   \
    real gscl_rint_##suffix(real) __asm__("llvm.rint." #suffix);   \
    real gscl_fabs_##suffix(real) __asm__("llvm.fabs." #suffix);   \
    real gscl_sqrt_##suffix(real) __asm__("llvm.sqrt." #suffix);   \
    real gscl_fma_##suffix(real, real, real) __asm__("llvm.fma." #suffix);
INTRINSICS(float, f32)
#if VECTOR_WIDTH >= 4
INTRINSICS(float4, v4f32)
#endif
#if VECTOR_WIDTH >= 8
INTRINSICS(float8, v8f32)
#endif
#if VECTOR_WIDTH >= 16
INTRINSICS(float16, v16f32)
#endif

/* All that follows is of one program alone: others have functions of the same names.  cl/native.py ends this. */
#pragma clang attribute push(__attribute__((internal_linkage)), apply_to = any(function, variable(is_global)))

#ifdef SOFTWARE_FMA
#define FMA(suffix, a, b, c) ((a) * (b) + (c))
#else
#define FMA(suffix, a, b, c) gscl_fma_##suffix(a, b, c)
#endif
#define OF_INTRINSICS(real, suffix)                               \
    BUILTIN real floor(real x) { return gscl_floor_##suffix(x); } \
    BUILTIN real ceil(real x) { return gscl_ceil_##suffix(x); }   \
    BUILTIN real rint(real x) { return gscl_rint_##suffix(x); }   \
    BUILTIN real fabs(real x) { return gscl_fabs_##suffix(x); }   \
    BUILTIN real sqrt(real x) { return gscl_sqrt_##suffix(x); }   \
    BUILTIN real fma(real a, real b, real c) { return FMA(suffix, a, b, c); }
#define OF_HALVES(real)                                                     \
    BUILTIN real floor(real x) { return (real)(floor(x.lo), floor(x.hi)); } \
    BUILTIN real ceil(real x) { return (real)(ceil(x.lo), ceil(x.hi)); }    \
    BUILTIN real rint(real x) { return (real)(rint(x.lo), rint(x.hi)); }    \
    BUILTIN real fabs(real x) { return (real)(fabs(x.lo), fabs(x.hi)); }    \
    BUILTIN real sqrt(real x) { return (real)(sqrt(x.lo), sqrt(x.hi)); }    \
    BUILTIN real fma(real a, real b, real c) { return (real)(fma(a.lo, b.lo, c.lo), fma(a.hi, b.hi, c.hi)); }
OF_INTRINSICS(float, f32)
#if VECTOR_WIDTH >= 4
OF_INTRINSICS(float4, v4f32)
#else
OF_HALVES(float2)
OF_HALVES(float4)
#endif
#if VECTOR_WIDTH >= 8
OF_INTRINSICS(float8, v8f32)
#else
OF_HALVES(float8)
#endif
#if VECTOR_WIDTH >= 16
OF_INTRINSICS(float16, v16f32)
#else
OF_HALVES(float16)
#endif
#undef OF_INTRINSICS
#undef OF_HALVES
#undef FMA

/* Written out, because instructions differ in which of two zeros is the larger.  Where y is a constant, one instruction of
 * x86-64 is left. */
#define OF_COMPARISONS(real, integer)                                                             \
    BUILTIN real fmax(real x, real y) { return x > y ? x : y == y ? y : x; }                      \
    BUILTIN real fmin(real x, real y) { return x < y ? x : y == y ? y : x; }                      \
    BUILTIN real clamp(real x, real low, real high) { return fmin(fmax(x, low), high); }          \
    BUILTIN real sign(real x) {                                                                   \
        return x > (real)(0.0f) ? (real)(1.0f) : x < (real)(0.0f) ? (real)(-1.0f) : (real)(0.0f); \
    }                                                                                             \
    BUILTIN real select(real no, real yes, integer mask) { return mask ? yes : no; }              \
    BUILTIN integer max(integer x, integer y) { return x < y ? y : x; }                           \
    BUILTIN integer min(integer x, integer y) { return y < x ? y : x; }                           \
    BUILTIN integer clamp(integer x, integer low, integer high) { return min(max(x, low), high); }
OF_COMPARISONS(float, int)
OF_COMPARISONS(float4, int4)
OF_COMPARISONS(float16, int16)
#undef OF_COMPARISONS

BUILTIN int convert_int(float x) { return (int)x; }
BUILTIN float convert_float(int x) { return (float)x; }
#define OF_VECTORS(n)                                                                                              \
    BUILTIN int##n convert_int##n(float##n x) { return __builtin_convertvector(x, int##n); }                       \
    BUILTIN float##n convert_float##n(int##n x) { return __builtin_convertvector(x, float##n); }                   \
    BUILTIN uchar##n convert_uchar##n(float##n x) { return __builtin_convertvector(convert_int##n(x), uchar##n); } \
    BUILTIN float##n clamp(float##n x, float low, float high) { return clamp(x, (float##n)(low), (float##n)(high)); }
OF_VECTORS(4)
OF_VECTORS(16)
#undef OF_VECTORS

/* Loads and stores of whole vectors, which lie at any element. */
#define OF_SPACE(space, type, n)                                                                       \
    __attribute__((overloadable, always_inline)) type##n vload##n(size_t at, const space type *p) {    \
        return *(const space type##n##_anywhere *)(p + at * n);                                        \
    }                                                                                                  \
    __attribute__((overloadable, always_inline)) void vstore##n(type##n v, size_t at, space type *p) { \
        *(space type##n##_anywhere *)(p + at * n) = v;                                                 \
    }
#define OF_MEMORY(type, n)                                                     \
    typedef type##n type##n##_anywhere __attribute__((aligned(sizeof(type)))); \
    OF_SPACE(__global, type, n)                                                \
    OF_SPACE(__private, type, n)
OF_MEMORY(float, 4)
OF_MEMORY(float, 8)
OF_MEMORY(float, 16)
OF_MEMORY(int, 4)
OF_MEMORY(int, 16)
OF_MEMORY(uint, 8)
OF_MEMORY(uchar, 16)
#undef OF_SPACE
#undef OF_MEMORY

/* ---- Exponentials and logarithms ----
 *
 * Minimax polynomials on one interval, without a branch.  Relative errors: exp2 and exp below 1.5e-7, log and log2 below
 * 2e-7 of the result or, near an argument of 1, of the distance from it. */

/* x 2^n for a whole number n, |n| <= 252: in two steps, because the factor may lie beyond the range of floats. */
#define OF_EXPONENTIALS(real, integer, as_real, as_integer, to_integer, to_real)                         \
    BUILTIN real gscl_scale(real x, real n) {                                                            \
        integer whole = to_integer(n), first = whole >> 1;                                               \
        return x * as_real((first + 127) << 23) * as_real((whole - first + 127) << 23);                  \
    }                                                                                                    \
    /* e^r, |r| <= ln(2) / 2 */                                                                          \
    BUILTIN real gscl_exp_part(real r) {                                                                 \
        real p = fma((real)(1.381454e-3f), r, (real)(8.3687451e-3f));                                    \
        p = fma(p, r, (real)(4.16683908e-2f));                                                           \
        p = fma(p, r, (real)(1.66665204e-1f));                                                           \
        p = fma(p, r, (real)(4.999999343e-1f));                                                          \
        return fma(p, r * r, r) + 1.0f;                                                                  \
    }                                                                                                    \
    BUILTIN real exp2(real x) {                                                                          \
        real bounded = clamp(x, (real)(-160.0f), (real)(160.0f)), n = rint(bounded);                     \
        real value = gscl_scale(gscl_exp_part((bounded - n) * 0.693147181f), n);                         \
        return x != x ? x : value;                                                                       \
    }                                                                                                    \
    BUILTIN real exp(real x) {                                                                           \
        real bounded = clamp(x, (real)(-110.0f), (real)(110.0f)), n = rint(bounded * 1.44269504f);       \
        real r = fma(n, (real)(-0.693359375f), bounded);                                                 \
        r = fma(n, (real)(2.12194440e-4f), r);                                                           \
        real value = gscl_scale(gscl_exp_part(r), n);                                                    \
        return x != x ? x : value;                                                                       \
    }                                                                                                    \
    /* Splits a positive x, subnormal ones included, into 2^n (1 + f), 1 + f in [sqrt(1/2), sqrt(2)). */ \
    BUILTIN real gscl_split(real x, real *n) {                                                           \
        integer is_small = x < (real)(0x1p-126f);                                                        \
        integer bits = as_integer(is_small ? x * 0x1p23f : x) - 0x3f3504f3;                              \
        *n = to_real(bits >> 23) - (is_small ? (real)(23.0f) : (real)(0.0f));                            \
        return as_real((bits & 0x7fffff) + 0x3f3504f3) - 1.0f;                                           \
    }                                                                                                    \
    /* ln(1 + f) - f + f^2 / 2 */                                                                        \
    BUILTIN real gscl_log_part(real f) {                                                                 \
        real p = fma((real)(-7.634497390e-02f), f, (real)(1.276157495e-01f));                            \
        p = fma(p, f, (real)(-1.316018108e-01f));                                                        \
        p = fma(p, f, (real)(1.420175822e-01f));                                                         \
        p = fma(p, f, (real)(-1.662335750e-01f));                                                        \
        p = fma(p, f, (real)(2.000122687e-01f));                                                         \
        p = fma(p, f, (real)(-2.500082103e-01f));                                                        \
        p = fma(p, f, (real)(3.333333171e-01f));                                                         \
        return p * f * f * f;                                                                            \
    }                                                                                                    \
    /* The value of a logarithm of x where x is not a positive number. */                                \
    BUILTIN real gscl_log_of(real x, real value) {                                                       \
        value = x == (real)(INFINITY) ? x : value;                                                       \
        value = x == (real)(0.0f) ? (real)(-INFINITY) : value;                                           \
        return x < (real)(0.0f) || x != x ? (real)(NAN) : value;                                         \
    }                                                                                                    \
    BUILTIN real log(real x) {                                                                           \
        real n, f = gscl_split(x, &n);                                                                   \
        real low = fma(n, (real)(-2.12194440e-4f), fma(f * f, (real)(-0.5f), gscl_log_part(f)));         \
        return gscl_log_of(x, fma(n, (real)(0.693359375f), f + low));                                    \
    }                                                                                                    \
    BUILTIN real log2(real x) {                                                                          \
        real n, f = gscl_split(x, &n), low = fma(f * f, (real)(-0.5f), gscl_log_part(f));                \
        real small = fma(f, (real)(0.44269504f), fma(low, (real)(0.44269504f), low));                    \
        return gscl_log_of(x, n + (f + small));                                                          \
    }                                                                                                    \
    /* x >= 0 */                                                                                         \
    BUILTIN real pow(real x, real y) { return exp2(y * log2(x)); }
OF_EXPONENTIALS(float, int, as_float, as_int, convert_int, convert_float)
OF_EXPONENTIALS(float16, int16, as_float16, as_int16, convert_int16, convert_float16)
#undef OF_EXPONENTIALS

/* x^n for n >= 0, by squaring. */
BUILTIN float pown(float x, int n) {
    float power = 1.0f;
    for (; n > 0; n >>= 1, x *= x)
        if (n & 1) power *= x;
    return power;
}

/* The angle of (x, y) in radians, -pi to pi; 0 where both are 0.  Absolute error below 3e-7. */
BUILTIN float atan2(float y, float x) {
    float ax = fabs(x), ay = fabs(y), larger = fmax(ax, ay);
    float t = larger > 0.0f ? fmin(ax, ay) / larger : 0.0f, t2 = t * t;
    float p = fma(2.456729800e-03f, t2, -1.440149270e-02f);
    p = fma(p, t2, 3.978168760e-02f);
    p = fma(p, t2, -7.234925390e-02f);
    p = fma(p, t2, 1.049899795e-01f);
    p = fma(p, t2, -1.416125073e-01f);
    p = fma(p, t2, 1.998591146e-01f);
    p = fma(p, t2, -3.333259749e-01f);
    p = fma(p, t2, 9.999998865e-01f);
    float angle = t * p;
    angle = ay > ax ? 1.57079633f - angle : angle;
    angle = x < 0.0f ? 3.14159265f - angle : angle;
    return y < 0.0f ? -angle : angle;
}
#undef BUILTIN
