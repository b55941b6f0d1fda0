/* The two parts of a step of the fit (step.cl) alone: gradients, and Adam with gradients that were made from them. */

/* Writes the gradients of splats, GSCL_PARAMS floats each.  Those of parameters that are not fitted are left as they are. */
__kernel GROUP_OF(STEP_ITEMS) void gather_gradients(
    __global const float *restrict params, __global const float *restrict steps, gscl_gather_settings settings,
    __global const float *restrict projected, __global const gscl_link_grid *restrict grids,
    __global const int *restrict links, __global const float *restrict slots, __global float *restrict gradients) {
    __local float shared[SLOT_ITEMS];
    vfloat gradient[FITTED];
    const size_t i = FIRST_SPLAT;
    int lanes_used;
    if (!gather(gradient, params, steps, settings, projected, grids, links, slots, shared, i, &lanes_used)) return;
    UNROLL
    for (int k = 0; k < FITTED; k++) store_lanes(gradient[k], gradients + i * GSCL_PARAMS + k, GSCL_PARAMS);
}

/* One step of Adam from the gradients, then the projection of the (quantised) result, for SPLAT_LANES splats. */
__kernel GROUP_OF(SPLAT_ITEMS) void adam_step(__global float *restrict params, __global float *restrict first_moment,
                                              __global float *restrict second_moment, __global int *restrict ages,
                                              __global const float *restrict gradients,
                                              __global const float *restrict steps, gscl_adam_settings settings,
                                              __global const gscl_fit_control *restrict control,
                                              __global float *restrict projected,
                                              __global float *restrict ellipse_bounds, __global int4 *restrict boxes) {
    const size_t i = get_global_id(0) * SPLAT_LANES;
    if (i >= (size_t)settings.splats) return;
    const int lanes_used = min(settings.splats - (int)i, SPLAT_LANES);
    vfloat gradient[FITTED];
    UNROLL
    for (int k = 0; k < FITTED; k++) gradient[k] = LOAD_LANES(gradients + i * GSCL_PARAMS + k, GSCL_PARAMS);
    take_step(params, first_moment, second_moment, ages, gradient, steps, settings, control, projected, ellipse_bounds,
              boxes, i, lanes_used);
}
