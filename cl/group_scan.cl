/* Prefix sums over the work-items of a group. */

/* Adds to each work-item's number those of the work-items before it, its own included.  `items`: of the group.  `sums` has
 * the result of each of them, and is free for other use after a barrier. */
long group_scan(long number, int items, __local long *restrict sums) {
    int item = (int)get_local_id(0);
    sums[item] = number;
    if (items > 1) barrier(CLK_LOCAL_MEM_FENCE);
    for (int distance = 1; distance < items; distance *= 2) {
        long other = item >= distance ? sums[item - distance] : 0;
        barrier(CLK_LOCAL_MEM_FENCE);
        sums[item] += other;
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    return sums[item];
}
