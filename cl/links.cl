/* Links: where a splat's entries are in the lists of the tiles.  It has one for each tile of its box: the number of its
 * entry in the tile's list, or -1.
 *
 * Links are numbered and set to -1 before the lists are filled, which then links each entry (bin.cl).
 *
 * Build options BAND_ITEMS, the work-items of a group that numbers links, as of one that lists the splats of a band (bin.cl),
 * and LINK_SPLATS, the splats that it takes: many by a single work-item on CPUs, a few by many on GPUs. */

/* The tiles of a box. */
long box_tiles(int4 box) {
    return box.x > box.y || box.z > box.w ? 0 : (long)(box.y - box.x + 1) * (long)(box.w - box.z + 1);
}

/* The links of a splat behind `before` other links; none where they do not fit in `capacity`. */
gscl_link_grid link_grid(int4 box, long before, int capacity) {
    long count = box_tiles(box);
    gscl_link_grid grid = {0, 0, 0, 0};
    if (before + count > (long)capacity) return grid;
    grid.first = (int)before;
    grid.count = (int)count;
    grid.stride = box.y - box.x + 1;
    grid.origin = (int)(before - (long)box.z * (long)grid.stride - (long)box.x);
    return grid;
}

/* The share of a work-item in the tiles of the boxes from `first` to before `end`. */
long tiles_of_item(__global const int4 *restrict boxes, int first, int end) {
    long own = 0;
    for (int i = first + (int)get_local_id(0); i < end; i += BAND_ITEMS) own += box_tiles(boxes[i]);
    return own;
}

/* The tiles of the boxes of each block of GSCL_LINK_BLOCK splats.  One work-group per block. */
__kernel GROUP_OF(BAND_ITEMS) void count_links(__global const int4 *restrict boxes, int count,
                                               __global long *restrict block_links) {
    __local long sums[BAND_ITEMS];
    const int first = (int)get_group_id(0) * GSCL_LINK_BLOCK, end = min(first + GSCL_LINK_BLOCK, count);
    group_scan(tiles_of_item(boxes, first, end), BAND_ITEMS, sums);
    if (get_local_id(0) == 0) block_links[get_group_id(0)] = sums[BAND_ITEMS - 1];
}

/* The links before splat `first`: of whole blocks of `block` splats, and of the splats behind these. */
long links_before(int first, __global const int4 *restrict boxes, int block, __global const long *restrict block_links,
                  __local long *restrict sums) {
    const int blocks = first / block;
    long own = tiles_of_item(boxes, blocks * block, first);
    for (int i = (int)get_local_id(0); i < blocks; i += BAND_ITEMS) own += block_links[i];
    group_scan(own, BAND_ITEMS, sums);
    return sums[BAND_ITEMS - 1];
}

/* Numbers the links of the LINK_SPLATS splats of group `group` and sets them to -1.  `block`: GSCL_LINK_BLOCK, or more than
 * `count`, which needs no counts of blocks.  *needed: links of all splats, at most 2^31 - 1. */
void number_links(int group, __global const int4 *restrict boxes, int count, int block,
                  __global const long *restrict block_links, int capacity, __global gscl_link_grid *restrict grids,
                  __global int *restrict links, __global int *restrict needed, __local long *restrict sums) {
    const int item = (int)get_local_id(0), first = group * LINK_SPLATS, end = min(first + LINK_SPLATS, count);
    long before = links_before(first, boxes, block, block_links, sums);
    for (int i = first; i < end; i++) {
        gscl_link_grid grid = link_grid(boxes[i], before, capacity);
        if (item == 0) grids[i] = grid;
        for (int k = item; k < grid.count; k += BAND_ITEMS) links[grid.first + k] = -1;
        before += box_tiles(boxes[i]);
    }
    if (item == 0 && end == count) *needed = before > 0x7fffffffL ? 0x7fffffff : (int)before;
}

/* Links an entry of the list of tile (tx, ty) to its splat; where there are no links (NULL), it does nothing. */
void link_entry(int entry, size_t splat, int tx, int ty, __global const gscl_link_grid *restrict grids,
                __global int *restrict links) {
    if (!links) return;
    gscl_link_grid grid = grids[splat];
    if (grid.count > 0) links[grid.origin + ty * grid.stride + tx] = entry;
}
