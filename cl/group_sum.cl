/* Sums over the work-items of a group, whose number is a power of 2: trees in a fixed order.
 *
 * Build option SUM_ITEMS, the work-items of a group of kernels that only sum: 1 on CPUs. */

/* Replaces each of `count` numbers by its sum over all work-items.  `sums` has room for `count` numbers of each of them, and
 * is free for other use after a barrier. */
void group_sums(float *restrict numbers, int count, __local float *restrict sums) {
    const int item = (int)get_local_id(0), items = (int)get_local_size(0);
    for (int k = 0; k < count; k++) sums[k * items + item] = numbers[k];
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int distance = items / 2; distance > 0; distance /= 2) {
        for (int k = 0; k < count && item < distance; k++) sums[k * items + item] += sums[k * items + item + distance];
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    for (int k = 0; k < count; k++) numbers[k] = sums[k * items];
}

/* The same for GSCL_SUM_ITEMS shares of a sum, of which the work-items of a group, a power of 2 and at most as many, have
 * stored `count` numbers each: number k of share j at sums[k * GSCL_SUM_ITEMS + j].  The totals lie at j = 0.  The order does
 * not depend on the number of work-items. */
void shares_sum(int count, __local float *restrict sums) {
    const int item = (int)get_local_id(0), items = (int)get_local_size(0);
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int distance = GSCL_SUM_ITEMS / 2; distance > 0; distance /= 2) {
        for (int k = 0; k < count; k++)
            for (int j = item; j < distance; j += items)
                sums[k * GSCL_SUM_ITEMS + j] += sums[k * GSCL_SUM_ITEMS + j + distance];
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}

/* The shares of this work-item. */
#define FOR_SHARES(j) for (int j = (int)get_local_id(0); j < GSCL_SUM_ITEMS; j += (int)get_local_size(0))
