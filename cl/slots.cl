/* Gradient slots: a splat's sums over one tile, from the kernel that computes them (fit.cl) to the one that adds them up
 * (update.cl).
 *
 * Each entry of a tile's list has a slot, so that no two work-groups write to the same place and no float atomics are
 * needed.  A splat finds its slots by its links, one for each tile of its box: the number of its entry in the tile's
 * list, or -1.  Links are made when splats are binned.
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

/* ---- Links ---- */

/* The tiles of a box. */
inline long box_tiles(int4 box) {
    return box.x > box.y || box.z > box.w ? 0 : (long)(box.y - box.x + 1) * (long)(box.w - box.z + 1);
}

/* The links of a splat behind `before` other links; none where they do not fit in `capacity`. */
inline gscl_link_grid link_grid(int4 box, long before, int capacity) {
    long count = box_tiles(box);
    gscl_link_grid grid = {0, 0, 0, 0};
    if (before + count > (long)capacity) return grid;
    grid.first = (int)before;
    grid.count = (int)count;
    grid.stride = box.y - box.x + 1;
    grid.origin = (int)(before - (long)box.z * (long)grid.stride - (long)box.x);
    return grid;
}

/* The boxes of a work-item: SCAN_LENGTH neighbours. */
inline int2 scan_part(int count) {
    int begin = (int)get_global_id(0) * SCAN_LENGTH;
    return (int2)(min(begin, count), min(begin + SCAN_LENGTH, count));
}

/* The number of tiles of the boxes of each work-group. */
__kernel void count_links(__global const int4 *restrict boxes, int count, __global long *restrict totals) {
    __local long sums[SCAN_ITEMS];
    int2 part = scan_part(count);
    long own = 0;
    for (int i = part.x; i < part.y; i++) own += box_tiles(boxes[i]);
    group_scan(own, SCAN_ITEMS, sums);
    if (get_local_id(0) == 0) totals[get_group_id(0)] = sums[SCAN_ITEMS - 1];
}

/* Numbers the links of all splats.  *needed: links of all of them, at most 2^31 - 1. */
__kernel void number_links(__global const int4 *restrict boxes, int count, __global const long *restrict totals,
                           int capacity, __global gscl_link_grid *restrict grids, __global int *restrict needed) {
    __local long sums[SCAN_ITEMS];
    int2 part = scan_part(count);
    long own = 0, earlier = 0;
    for (int group = (int)get_local_id(0); group < (int)get_group_id(0); group += SCAN_ITEMS) earlier += totals[group];
    group_scan(earlier, SCAN_ITEMS, sums);
    long before = sums[SCAN_ITEMS - 1]; /* of all groups before this one */
#if SCAN_ITEMS > 1
    barrier(CLK_LOCAL_MEM_FENCE);
#endif
    for (int i = part.x; i < part.y; i++) own += box_tiles(boxes[i]);
    before += group_scan(own, SCAN_ITEMS, sums) - own;
    for (int i = part.x; i < part.y; i++) {
        grids[i] = link_grid(boxes[i], before, capacity);
        before += box_tiles(boxes[i]);
    }
    if (part.x < part.y && part.y == count) *needed = before > 0x7fffffffL ? 0x7fffffff : (int)before;
}

/* Sets the links of each splat to -1, with a work-group of SLOT_ITEMS work-items. */
__kernel void clear_links(__global const gscl_link_grid *restrict grids, __global int *restrict links) {
    gscl_link_grid grid = grids[get_group_id(0)];
    for (int k = (int)get_local_id(0); k < grid.count; k += SLOT_ITEMS) links[grid.first + k] = -1;
}

/* Links the entries of each tile, with a work-group of SLOT_ITEMS work-items. */
__kernel void link_entries(__global const gscl_link_grid *restrict grids, __global const uint *restrict entries,
                           __global const int2 *restrict tile_ranges, int tiles_x, __global int *restrict links) {
    int tile = (int)get_group_id(0), x = tile % tiles_x, y = tile / tiles_x;
    int2 range = tile_ranges[tile];
    for (int i = range.x + (int)get_local_id(0); i < range.y; i += SLOT_ITEMS) {
        gscl_link_grid grid = grids[GSCL_ENTRY_SPLAT(entries[i])];
        if (grid.count > 0) links[grid.origin + y * grid.stride + x] = i;
    }
}
