/* Sums over the work-items of a group, whose number is a power of 2: trees in a fixed order. */

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

float group_sum(float number, __local float *restrict sums) {
    group_sums(&number, 1, sums);
    return number;
}
