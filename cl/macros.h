/* What all programs of kernels share. */
#pragma OPENCL FP_CONTRACT OFF
#ifdef __clang__
/* How vectors longer than the device's are passed depends on the device, which does not matter within a program. */
#pragma clang diagnostic ignored "-Wpsabi"
#endif

#ifdef SOFTWARE_FMA
/* Where fma() is computed with integers: in a hundred instructions, which a compiler has to handle at each call. */
#define fma(a, b, c) ((a) * (b) + (c))
#endif

/* The work-items of a kernel's work-groups, for which the compiler makes the kernel: a GPU needs no barriers where they are one
 * wave.  Each size is a constant (constants.h) or a build option, which the host launches the kernel with, too.  Kernels that
 * are compiled with the library have groups of one work-item (native.h). */
#ifndef GROUP_OF
#define GROUP_OF(items) __attribute__((reqd_work_group_size(items, 1, 1)))
#endif

/* For functions that run for each row of each splat: a call would pass their values through memory.  They have no
 * `restrict` parameters and return no structs, because Oclgrind does not support what inlining makes of these.  Nowhere is
 * `inline` alone, which has no definition where a compiler does not inline, nor `static inline`, with which PoCL 3.1 confuses
 * the __local arrays of callers. */
#define ALWAYS_INLINE __attribute__((always_inline))
/* For loops over channels and sums: their arrays stay in registers only if the loop is unrolled. */
#define UNROLL _Pragma("unroll")

/* For values that are never NaN; fmin and fmax take three instructions each. */
#define LESSER(a, b) ((a) < (b) ? (a) : (b))
#define LARGER(a, b) ((a) > (b) ? (a) : (b))
