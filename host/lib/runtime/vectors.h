/* Vectors that kernels take by value or that buffers consist of, in the layout of OpenCL C: aligned to their size. */
#ifndef GSCL_LIB_VECTORS_H
#define GSCL_LIB_VECTORS_H

#include <stdint.h>

#define GSCL_ALIGNED(size) __attribute__((aligned(size)))

typedef struct gscl_int2 {
    int32_t s[2];
} GSCL_ALIGNED(8) gscl_int2;

typedef struct gscl_int4 {
    int32_t s[4];
} GSCL_ALIGNED(16) gscl_int4;

typedef struct gscl_float2 {
    float s[2];
} GSCL_ALIGNED(8) gscl_float2;

#endif
