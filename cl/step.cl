/* A step of the fit: gradients, Adam, and the projection of the (quantised) result. */
__kernel void step_splats(__global float *restrict params, __global float *restrict first_moment,
                          __global float *restrict second_moment, __global int *restrict ages,
                          __global const float *restrict steps, gscl_gather_settings drawn, gscl_adam_settings settings,
                          __global const gscl_fit_control *restrict control,
                          __global const gscl_link_grid *restrict grids, __global const int *restrict links,
                          __global const float *restrict slots, __global float *restrict projected,
                          __global float *restrict ellipse_bounds, __global int4 *restrict boxes) {
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
    splat_gradient(gradient, sums, params, steps, drawn.view, projected, i, lanes_used);
    settings.limits.log_max = control->log_max;
    step_params(params, first_moment, second_moment, ages, gradient, settings, i, lanes_used);
    splat_store_projected(splat_quantise(splat_load(params + i * GSCL_PARAMS, lanes_used), steps), settings.view, i,
                          projected, ellipse_bounds, boxes);
}
