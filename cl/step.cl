/* A step of the fit: gradients, Adam, and the projection of the (quantised) result. */
__kernel GROUP_OF(STEP_ITEMS) void step_splats(__global float *restrict params, __global float *restrict first_moment,
                                               __global float *restrict second_moment, __global int *restrict ages,
                                               __global const float *restrict steps, gscl_gather_settings drawn,
                                               gscl_adam_settings settings,
                                               __global const gscl_fit_control *restrict control,
                                               __global const gscl_link_grid *restrict grids,
                                               __global const int *restrict links, __global const float *restrict slots,
                                               __global float *restrict projected,
                                               __global float *restrict ellipse_bounds, __global int4 *restrict boxes) {
    __local float shared[SLOT_ITEMS];
    vfloat gradient[FITTED];
    const size_t i = FIRST_SPLAT;
    int lanes_used;
    if (gather(gradient, params, steps, drawn, projected, grids, links, slots, shared, i, &lanes_used))
        take_step(params, first_moment, second_moment, ages, gradient, steps, settings, control, projected,
                  ellipse_bounds, boxes, i, lanes_used);
}
