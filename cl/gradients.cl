/* The two parts of a step of the fit (step.cl) alone: gradients, and Adam with gradients that were made from them. */

/* Writes the gradients of splats, GSCL_PARAMS floats each.  Those of parameters that are not fitted are left as they are. */
__kernel void gather_gradients(__global const float *restrict params, __global const float *restrict steps,
                               gscl_gather_settings settings, __global const float *restrict projected,
                               __global const gscl_link_grid *restrict grids, __global const int *restrict links,
                               __global const float *restrict slots, __global float *restrict gradients) {
    __local float shared[SLOT_ITEMS];
    float sums[SPLAT_LANES * SLOT];
    vfloat gradient[FITTED];
    int lanes_used;
    const size_t i = own_splats(settings.splats, &lanes_used);
#if SLOT_ITEMS == 1
    if (lanes_used <= 0) return;
#endif
    slots_sum(sums, i, lanes_used, grids, links, slots, shared);
    if (SLOT_ITEMS > 1 && get_local_id(0) > 0) return;
    splat_gradient(gradient, sums, params, steps, settings.view, projected, i, lanes_used);
    UNROLL
    for (int k = 0; k < FITTED; k++) store_lanes(gradient[k], gradients + i * GSCL_PARAMS + k, GSCL_PARAMS);
}

/* One step of Adam from the gradients, then the projection of the (quantised) result, for SPLAT_LANES splats. */
__kernel void adam_step(__global float *restrict params, __global float *restrict first_moment,
                        __global float *restrict second_moment, __global int *restrict ages,
                        __global const float *restrict gradients, __global const float *restrict steps,
                        gscl_adam_settings settings, __global const gscl_fit_control *restrict control,
                        __global float *restrict projected, __global float *restrict ellipse_bounds,
                        __global int4 *restrict boxes) {
    const size_t i = get_global_id(0) * SPLAT_LANES, at = i * GSCL_PARAMS;
    if (i >= (size_t)settings.splats) return;
    const int lanes_used = min(settings.splats - (int)i, SPLAT_LANES);
    vfloat gradient[FITTED];
    UNROLL
    for (int k = 0; k < FITTED; k++) gradient[k] = LOAD_LANES(gradients + at + k, GSCL_PARAMS);
    settings.limits.log_max = control->log_max;
    step_params(params, first_moment, second_moment, ages, gradient, settings, i, lanes_used);
    splat_store_projected(splat_quantise(splat_load(params + at, lanes_used), steps), settings.view, i, projected,
                          ellipse_bounds, boxes);
}
