/* What the device can do at best: the measures that other kernels are held against. */

#define CHAINS GSCL_BENCHMARK_CHAINS

/* 2 * CHAINS * GSCL_BENCHMARK_LENGTH * LANES operations a work-item. */
__kernel void multiply_add(float factor, __global float *restrict sums) {
    pix chains[CHAINS], sum = (pix)(0.0f);
    UNROLL
    for (int j = 0; j < CHAINS; j++) chains[j] = pix_offsets() + (float)(j + (int)get_global_id(0));
    for (int i = 0; i < GSCL_BENCHMARK_LENGTH; i++) {
        UNROLL
        for (int j = 0; j < CHAINS; j++) chains[j] = fma(chains[j], (pix)(factor), (pix)(1.0f));
    }
    UNROLL
    for (int j = 0; j < CHAINS; j++) sum += chains[j];
    sums[get_global_id(0)] = pix_sum(sum); /* something that needs it all */
}

/* Reads and writes a pixel vector a work-item. */
__kernel void copy(__global const float *restrict from, __global float *restrict to) {
    size_t at = get_global_id(0) * LANES;
    PIX_STORE(PIX_LOAD(from + at), to + at);
}
