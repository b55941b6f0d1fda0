/* Peak rates of the device, with which the rates of the other kernels are compared. */

#define CHAINS GSCL_BENCHMARK_CHAINS

/* Multiply-adds without access to memory: 2 * CHAINS * GSCL_BENCHMARK_LENGTH * LANES operations a work-item. */
__kernel GROUP_OF(GSCL_BENCHMARK_GROUP) void multiply_add(float factor, __global float *restrict sums) {
    pix chains[CHAINS], sum = (pix)(0.0f);
    UNROLL
    for (int j = 0; j < CHAINS; j++) chains[j] = pix_offsets() + (float)(j + (int)get_global_id(0));
    for (int i = 0; i < GSCL_BENCHMARK_LENGTH; i++) {
        UNROLL
        for (int j = 0; j < CHAINS; j++) chains[j] = fma(chains[j], (pix)(factor), (pix)(1.0f));
    }
    UNROLL
    for (int j = 0; j < CHAINS; j++) sum += chains[j];
    sums[get_global_id(0)] = pix_sum(sum); /* keeps the compiler from removing the loops */
}

/* Each work-item reads and writes one pixel vector. */
__kernel GROUP_OF(GSCL_BENCHMARK_GROUP) void copy(__global const float *restrict from, __global float *restrict to) {
    size_t at = get_global_id(0) * LANES;
    PIX_STORE(PIX_LOAD(from + at), to + at);
}
