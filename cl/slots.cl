/* Gradient slots: a splat's sums over one tile, from the kernel that computes them (fit.cl) to the one that adds them up
 * (update.cl).
 *
 * Each splat has a slot for each tile of its box, so that no two work-groups write to the same place, no float atomics
 * are needed, and the slots of a splat lie one after another.  Tiles of the box that its outline does not touch do not
 * list it; their slots stay 0 from one binning to the next.
 *
 * With h = dL/dweight and t = h * opacity * gauss, a slot holds
 *     sum t u, t v, t u^2, [t u v,] t v^2, [h weight,] w dL/dcolour for each channel, and [w dL/dwave times the wave a
 *     quarter of a turn on, whose phase moves with the splat].
 * A circle has one sum instead of t u^2 and t v^2. */
#define SLOT_VV GSCL_SLOT_VV(SHAPE)
#define SLOT_OPACITY GSCL_SLOT_OPACITY(SHAPE)
#define SLOT_COLOUR GSCL_SLOT_COLOUR(SHAPE, OPACITY)
#define SLOT_WAVE GSCL_SLOT_WAVE(SHAPE, OPACITY, CHANNELS)
#define SLOT GSCL_SLOT_SIZE(SHAPE, OPACITY, CHANNELS, TEXTURE)

/* The tiles of a box. */
inline long box_tiles(int4 box) {
    return box.x > box.y || box.z > box.w ? 0 : (long)(box.y - box.x + 1) * (long)(box.w - box.z + 1);
}

/* The slot of a splat that has slots in the tile (x, y). */
inline int slot_of_tile(gscl_slot_grid grid, int2 tile) { return grid.origin + tile.y * grid.stride + tile.x; }

/* The slots of a splat behind `before` other slots; none where they do not fit in `capacity`. */
inline gscl_slot_grid slot_grid(int4 box, long before, int capacity) {
    long count = box_tiles(box);
    gscl_slot_grid grid = {0, 0, 0, 0};
    if (before + count > (long)capacity) return grid;
    grid.first = (int)before;
    grid.count = (int)count;
    grid.stride = box.y - box.x + 1;
    grid.origin = (int)(before - (long)box.z * (long)grid.stride - (long)box.x);
    return grid;
}

/* Adds to each work-item's number those of the work-items before it, its own included. */
inline long slots_scan(long number, __local long *restrict sums) {
#if SCAN_ITEMS > 1
    int item = (int)get_local_id(0);
    sums[item] = number;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int distance = 1; distance < SCAN_ITEMS; distance *= 2) {
        long other = item >= distance ? sums[item - distance] : 0;
        barrier(CLK_LOCAL_MEM_FENCE);
        sums[item] += other;
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    return sums[item];
#else
    sums[0] = number;
    return number;
#endif
}

/* The boxes of a work-item: SCAN_LENGTH neighbours. */
inline int2 scan_part(int count) {
    int begin = (int)get_global_id(0) * SCAN_LENGTH;
    return (int2)(min(begin, count), min(begin + SCAN_LENGTH, count));
}

/* The number of tiles of the boxes of each work-group. */
__kernel void count_slots(__global const int4 *restrict boxes, int count, __global long *restrict totals) {
    __local long sums[SCAN_ITEMS];
    int2 part = scan_part(count);
    long own = 0;
    for (int i = part.x; i < part.y; i++) own += box_tiles(boxes[i]);
    slots_scan(own, sums);
    if (get_local_id(0) == 0) totals[get_group_id(0)] = sums[SCAN_ITEMS - 1];
}

/* Numbers the slots of all splats.  *needed: slots of all of them, at most 2^31 - 1. */
__kernel void number_slots(__global const int4 *restrict boxes, int count, __global const long *restrict totals,
                           int capacity, __global gscl_slot_grid *restrict grids, __global int *restrict needed) {
    __local long sums[SCAN_ITEMS];
    int2 part = scan_part(count);
    long own = 0, earlier = 0;
    for (int group = (int)get_local_id(0); group < (int)get_group_id(0); group += SCAN_ITEMS) earlier += totals[group];
    slots_scan(earlier, sums);
    long before = sums[SCAN_ITEMS - 1]; /* of all groups before this one */
#if SCAN_ITEMS > 1
    barrier(CLK_LOCAL_MEM_FENCE);
#endif
    for (int i = part.x; i < part.y; i++) own += box_tiles(boxes[i]);
    before += slots_scan(own, sums) - own;
    for (int i = part.x; i < part.y; i++) {
        grids[i] = slot_grid(boxes[i], before, capacity);
        before += box_tiles(boxes[i]);
    }
    if (part.x < part.y && part.y == count) *needed = before > 0x7fffffffL ? 0x7fffffff : (int)before;
}

/* Sets the slots of each splat to 0, with SLOT_ITEMS work-items. */
__kernel void clear_slots(__global const gscl_slot_grid *restrict grids, int count, __global float *restrict slots) {
    int i = (int)get_group_id(0);
    gscl_slot_grid grid = grids[i];
    slots += (size_t)grid.first * SLOT;
    for (int k = (int)get_local_id(0); k < grid.count * SLOT; k += SLOT_ITEMS) slots[k] = 0.0f;
}
