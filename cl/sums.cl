/* Sums over an image, of work-groups of GSCL_SUM_ITEMS work-items, and what a fit takes from them.  All are trees in an order
 * that does not depend on the device (group_sum.cl), so that the same input always gives the same sum. */

/* A sum that keeps what rounding lost (Kahan): of each work-item, which adds up many numbers of a large image. */
typedef struct {
    float sum, lost;
} long_sum;

long_sum long_sum_add(long_sum s, float number) {
    float y = number - s.lost, t = s.sum + y;
    s.lost = (t - s.sum) - y;
    s.sum = t;
    return s;
}

/* Squared error of the pixels of each work-group, `share` neighbours; the last group may have fewer. */
__kernel void sum_squared_error(__global const float *restrict rendering, __global const float *restrict target,
                                int channels, int weighted, int count, int share, __global float *restrict group_sums) {
    __local float sums[GSCL_SUM_ITEMS];
    int first = (int)get_group_id(0) * share, end = min(count - first, share);
    long_sum own = {0.0f, 0.0f};
    for (int i = (int)get_local_id(0); i < end; i += GSCL_SUM_ITEMS)
        own = long_sum_add(own, error_of_pixel(rendering, target, channels, weighted, count, first + i));
    float total = group_sum(own.sum, sums);
    if (get_local_id(0) == 0) group_sums[get_group_id(0)] = total;
}

/* The sum of a plane's values, likewise. */
__kernel void sum_plane(__global const float *restrict plane, int count, int share,
                        __global float *restrict group_sums) {
    __local float sums[GSCL_SUM_ITEMS];
    int first = (int)get_group_id(0) * share, end = min(count - first, share);
    long_sum own = {0.0f, 0.0f};
    for (int i = (int)get_local_id(0); i < end; i += GSCL_SUM_ITEMS) own = long_sum_add(own, plane[first + i]);
    float total = group_sum(own.sum, sums);
    if (get_local_id(0) == 0) group_sums[get_group_id(0)] = total;
}

/* Adds up the sums of groups, and `factor` times another number.  One work-group. */
__kernel void sum_groups(__global const float *restrict group_sums, int count, float factor,
                         __global const float *restrict other, __global float *restrict total) {
    __local float sums[GSCL_SUM_ITEMS];
    long_sum own = {0.0f, 0.0f};
    for (int i = (int)get_local_id(0); i < count; i += GSCL_SUM_ITEMS) own = long_sum_add(own, group_sums[i]);
    float all = group_sum(own.sum, sums);
    if (get_local_id(0) == 0) *total = factor == 0.0f ? all : fma(factor, *other, all);
}

/* The mean loss of a step from those of its tiles.  One work-group.  `scale`: 1 / samples. */
__kernel void sum_loss(__global const float *restrict tile_loss, int count, float scale,
                       __global gscl_fit_control *restrict control) {
    __local float sums[GSCL_SUM_ITEMS];
    long_sum own = {0.0f, 0.0f};
    for (int i = (int)get_local_id(0); i < count; i += GSCL_SUM_ITEMS) own = long_sum_add(own, tile_loss[i]);
    float total = group_sum(own.sum, sums);
    if (get_local_id(0) == 0) control->loss = total * scale;
}

/* Bounds the axes where the lists of the tiles are long, sets the threshold of skipped tiles, and counts low splats.  One
 * work-group. */
__kernel void control_fit(__global const int *restrict row_totals, int rows,
                          __global const float *restrict ellipse_bounds, gscl_control_settings settings,
                          __global gscl_fit_control *restrict control) {
    __local float sums[GSCL_SUM_ITEMS], low_sums[GSCL_SUM_ITEMS];
    float own = 0.0f, own_low = 0.0f;
    for (int i = (int)get_local_id(0); i < rows; i += GSCL_SUM_ITEMS) own += (float)row_totals[i];
    for (int i = (int)get_local_id(0); i < settings.splats; i += GSCL_SUM_ITEMS)
        own_low +=
            ellipse_bounds[(size_t)i * GSCL_BOUNDS + GSCL_BOUNDS_HALF_HEIGHT] < settings.low_height ? 1.0f : 0.0f;
    float entries = group_sum(own, sums), low = group_sum(own_low, low_sums);
    if (get_local_id(0) > 0) return;
    control->low_splats = low / fmax((float)settings.splats, 1.0f);
    if (entries > settings.max_entries)
        control->log_max = fmax(control->log_max - settings.reduction, settings.log_min);
    if (settings.threshold_per_loss > 0.0f) control->skip_threshold = settings.threshold_per_loss * control->loss;
}
