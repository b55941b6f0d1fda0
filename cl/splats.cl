/* Projecting all splats. */

/* Projects the splats as they are, or quantised. */
__kernel GROUP_OF(SPLAT_ITEMS) void project(__global const float *restrict params, __global const float *restrict steps,
                                            int count, gscl_view view, __global float *restrict projected,
                                            __global float *restrict ellipse_bounds, __global int4 *restrict boxes) {
    size_t i = get_global_id(0) * SPLAT_LANES;
    if (i >= (size_t)count) return;
    splat s = splat_load(params + i * GSCL_PARAMS, count - (int)i);
    splat_store_projected(splat_quantise(s, steps), view, i, projected, ellipse_bounds, boxes);
}
