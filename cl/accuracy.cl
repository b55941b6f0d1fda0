/* Projection in double precision, for measuring the accuracy of single precision (host/lib/measure/accuracy.c). */

/* Projects splats at full size, as `project` does in single precision, but always as rotated splats. */
__kernel GROUP_OF(GSCL_SPLATS_PER_GROUP) void project_double(__global const float *restrict params, int count,
                                                             __global real *restrict projected) {
    int i = (int)get_global_id(0);
    if (i >= count) return;
    __global const float *p = params + (size_t)i * GSCL_PARAMS;
    __global real *d = projected + (size_t)i * GSCL_PROJECTED;
    const real to_frame = sqrt((real)M_LOG2E / 2); /* exp(-d^2 / 2) = 2^-(to_frame d)^2 */
    real c = cos((real)p[GSCL_THETA]), n = sin((real)p[GSCL_THETA]);
    real i1 = to_frame / exp((real)p[GSCL_LOG_S1]), i2 = to_frame / exp((real)p[GSCL_LOG_S2]);
    d[GSCL_PROJECTED_X] = p[GSCL_X];
    d[GSCL_PROJECTED_Y] = p[GSCL_Y];
    d[GSCL_PROJECTED_UX] = c * i1;
    d[GSCL_PROJECTED_UY] = n * i1;
    d[GSCL_PROJECTED_VX] = -n * i2;
    d[GSCL_PROJECTED_VY] = c * i2;
    d[GSCL_PROJECTED_OPACITY] = OPACITY ? 1 / (1 + exp(-(real)p[GSCL_OPACITY])) : 1;
    for (int k = 0; k < CHANNELS; k++) d[GSCL_PROJECTED_COLOUR + k] = p[GSCL_COLOUR + k];
    for (int k = 0; k < 4; k++) d[GSCL_PROJECTED_WAVE_X + k] = p[GSCL_WAVE_X + k];
}
