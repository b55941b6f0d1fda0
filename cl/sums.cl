/* Sums over an image in GSCL_SUM_ITEMS shares by each work-group, and what a fit takes from them.  All are trees in an order
 * that does not depend on the device or on the size of the groups (group_sum.cl), so that the same input always gives the
 * same sum. */

/* A sum that keeps what rounding lost (Kahan): of each share, which adds up many numbers of a large image. */
typedef struct {
    float sum, lost;
} long_sum;

long_sum long_sum_add(long_sum s, float number) {
    float y = number - s.lost, t = s.sum + y;
    s.lost = (t - s.sum) - y;
    s.sum = t;
    return s;
}

/* Share `j` of the sum of `count` numbers. */
float share_sum(__global const float *restrict numbers, int count, int j) {
    long_sum own = {0.0f, 0.0f};
    for (int i = j; i < count; i += GSCL_SUM_ITEMS) own = long_sum_add(own, numbers[i]);
    return own.sum;
}

/* The sum of `count` numbers at sums[0]. */
void share_sums(__global const float *restrict numbers, int count, __local float *restrict sums) {
    FOR_SHARES(j) sums[j] = share_sum(numbers, count, j);
    shares_sum(1, sums);
}

/* Squared error of the pixels of each work-group, `share` neighbours; the last group may have fewer. */
__kernel GROUP_OF(SUM_ITEMS) void sum_squared_error(__global const float *restrict rendering,
                                                    __global const float *restrict target, int channels, int weighted,
                                                    int count, int share, __global float *restrict group_sums) {
    __local float sums[GSCL_SUM_ITEMS];
    int first = (int)get_group_id(0) * share, end = min(count - first, share);
    FOR_SHARES(j) {
        long_sum own = {0.0f, 0.0f};
        for (int i = j; i < end; i += GSCL_SUM_ITEMS)
            own = long_sum_add(own, error_of_pixel(rendering, target, channels, weighted, count, first + i));
        sums[j] = own.sum;
    }
    shares_sum(1, sums);
    if (get_local_id(0) == 0) group_sums[get_group_id(0)] = sums[0];
}

/* The sum of a plane's values, likewise. */
__kernel GROUP_OF(SUM_ITEMS) void sum_plane(__global const float *restrict plane, int count, int share,
                                            __global float *restrict group_sums) {
    __local float sums[GSCL_SUM_ITEMS];
    int first = (int)get_group_id(0) * share, end = min(count - first, share);
    share_sums(plane + first, end, sums);
    if (get_local_id(0) == 0) group_sums[get_group_id(0)] = sums[0];
}

/* Adds up the sums of groups, and `factor` times another number.  One work-group. */
__kernel GROUP_OF(SUM_ITEMS) void sum_groups(__global const float *restrict group_sums, int count, float factor,
                                             __global const float *restrict other, __global float *restrict total) {
    __local float sums[GSCL_SUM_ITEMS];
    share_sums(group_sums, count, sums);
    if (get_local_id(0) == 0) *total = factor == 0.0f ? sums[0] : fma(factor, *other, sums[0]);
}

/* Share `j` of the number of low splats among `count`. */
float low_share(__global const float *restrict ellipse_bounds, int count, float low_height, int j) {
    float own = 0.0f;
    for (int i = j; i < count; i += GSCL_SUM_ITEMS)
        own += ellipse_bounds[(size_t)i * GSCL_BOUNDS + GSCL_BOUNDS_HALF_HEIGHT] < low_height ? 1.0f : 0.0f;
    return own;
}

#if SUM_ITEMS > 1
/* Sums the losses of GSCL_CONTROL_PART tiles and counts the low ones of as many splats, by each work-group, where sum_loss and
 * control_fit alone would take long. */
__kernel GROUP_OF(SUM_ITEMS) void begin_control(__global const float *restrict tile_loss, int tiles,
                                                __global const float *restrict ellipse_bounds, int splats,
                                                float low_height, __global float *restrict loss_parts,
                                                __global float *restrict low_parts) {
    __local float sums[2 * GSCL_SUM_ITEMS];
    const int part = (int)get_group_id(0), first = part * GSCL_CONTROL_PART;
    FOR_SHARES(j) {
        sums[j] = share_sum(tile_loss + first, min(tiles - first, GSCL_CONTROL_PART), j);
        sums[GSCL_SUM_ITEMS + j] = low_share(ellipse_bounds + (size_t)first * GSCL_BOUNDS,
                                             min(splats - first, GSCL_CONTROL_PART), low_height, j);
    }
    shares_sum(2, sums);
    if (get_local_id(0) > 0) return;
    loss_parts[part] = sums[0];
    low_parts[part] = sums[GSCL_SUM_ITEMS];
}
#endif

/* The mean loss of a step from those of its tiles or of parts of them.  One work-group.  `scale`: 1 / samples. */
__kernel GROUP_OF(SUM_ITEMS) void sum_loss(__global const float *restrict losses, int count, float scale,
                                           __global gscl_fit_control *restrict control) {
    __local float sums[GSCL_SUM_ITEMS];
    share_sums(losses, count, sums);
    if (get_local_id(0) == 0) control->loss = sums[0] * scale;
}

/* Bounds the axes where the lists of the tiles are long, counts low splats, and sets the threshold of skipped tiles, which
 * follows the mean loss of a step, as of sum_loss.  One work-group. */
__kernel GROUP_OF(SUM_ITEMS) void control_fit(__global const int *restrict row_totals, int rows,
                                              __global const float *restrict ellipse_bounds,
                                              __global const float *restrict low_parts,
                                              __global const float *restrict losses, gscl_control_settings settings,
                                              __global gscl_fit_control *restrict control) {
    __local float sums[3 * GSCL_SUM_ITEMS];
    FOR_SHARES(j) {
        float own = 0.0f;
        for (int i = j; i < rows; i += GSCL_SUM_ITEMS) own += (float)row_totals[i];
        sums[j] = own;
        sums[GSCL_SUM_ITEMS + j] = settings.low_parts > 0
                                       ? share_sum(low_parts, settings.low_parts, j)
                                       : low_share(ellipse_bounds, settings.splats, settings.low_height, j);
        sums[2 * GSCL_SUM_ITEMS + j] = share_sum(losses, settings.losses, j);
    }
    shares_sum(3, sums);
    if (get_local_id(0) > 0) return;
    const float entries = sums[0], low = sums[GSCL_SUM_ITEMS];
    control->low_splats = low / fmax((float)settings.splats, 1.0f);
    if (entries > settings.max_entries)
        control->log_max = fmax(control->log_max - settings.reduction, settings.log_min);
    if (settings.losses == 0) return;
    control->loss = sums[2 * GSCL_SUM_ITEMS] * settings.loss_scale;
    control->skip_threshold = settings.threshold_per_loss * control->loss;
}
