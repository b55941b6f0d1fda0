/* Binning: for every tile the ascending list of the splats whose outline touches it.
 *
 * A work-group goes over the splats in their order, so the lists come out sorted without atomics and the same input always
 * gives the same lists.  Each row of tiles owns `row_capacity` entries.  Further entries are left out; the host reads their
 * number from row_totals and grows the lists.
 *
 * Build options BAND_ITEMS and BIN_ITEMS, the work-items of a group that lists the splats of a band, and that fills lists.
 * Both are 1 on CPUs: the only one takes splat after splat and appends it to the lists of a row of tiles.  On GPUs each
 * tile has a group, whose work-items take a splat each, and scatter those that touch the tile to the places that a scan gives
 * them, behind those of the tiles to the left.  These were counted before: in small images where bands are listed, in others
 * by a kernel in between.
 *
 * The lists of a fit link their entries to the splats (links.cl).  Others have no links: NULL. */

/* Tiles of a row whose rows of pixels are found together. */
#define BIN_LANES 4

/* First and last tile of row `ty` of its box that the outline touches, widened by a margin for rounding. */
ALWAYS_INLINE int2 tiles_touched(__global const float *projected, __global const float *bounds, int4 box, int ty) {
    float half_width = bounds[GSCL_BOUNDS_HALF_WIDTH], half_height = bounds[GSCL_BOUNDS_HALF_HEIGHT];
    float x = projected[GSCL_PROJECTED_X], y0 = (float)(ty * GSCL_TILE) + 0.5f - projected[GSCL_PROJECTED_Y];
    float low = LARGER(y0, -half_height), high = LESSER(y0 + (float)(GSCL_TILE - 1), half_height);
    high = LARGER(high, low); /* the row is touched at its edge, or missed by a rounding error */
    /* dy of the leftmost and of the rightmost point, within the row */
    float right_dy = bounds[GSCL_BOUNDS_SLOPE] * half_width, slope = bounds[GSCL_BOUNDS_SLOPE_X];
    float width2 = bounds[GSCL_BOUNDS_WIDTH2], curve = bounds[GSCL_BOUNDS_CURVE_X];
    float dy0 = LESSER(LARGER(-right_dy, low), high), dy1 = LESSER(LARGER(right_dy, low), high);
    float arc0 = width2 - curve * dy0 * dy0, arc1 = width2 - curve * dy1 * dy1;
    float left = slope * dy0 - sqrt(LARGER(arc0, 0.0f)), right = slope * dy1 + sqrt(LARGER(arc1, 0.0f));
    float margin = 1e-3f * (1.0f + half_width) + 1e-6f * fabs(x);
    left = (x + LARGER(left, -half_width) - margin) * (1.0f / GSCL_TILE);
    right = (x + LESSER(right, half_width) + margin) * (1.0f / GSCL_TILE);
    /* Clamped as floats, since those of a very large splat do not fit an int.  The box has no negative tiles. */
    float first = (float)box.x, last = (float)box.y;
    left = LESSER(LARGER(left, first), last + 1.0f);
    right = LESSER(LARGER(right, first - 1.0f), last);
    return (int2)(min((int)left, box.y), max((int)right, box.x));
}

/* Rows of the tiles (tx, ty), (tx + 1, ty), ... that the outline touches: first and last; none where first > last. */
void rows_touched(__global const float *restrict projected, __global const float *restrict bounds, int tx, int ty,
                  int *restrict first, int *restrict last) {
    float4 x0 = (float4)(0, GSCL_TILE, 2 * GSCL_TILE, 3 * GSCL_TILE) +
                ((float)(tx * GSCL_TILE) + 0.5f - projected[GSCL_PROJECTED_X]);
    float y0 = (float)(ty * GSCL_TILE) + 0.5f - projected[GSCL_PROJECTED_Y];
    float half_height = bounds[GSCL_BOUNDS_HALF_HEIGHT];
    float4 half_width = (float4)(bounds[GSCL_BOUNDS_HALF_WIDTH]), zero = (float4)(0.0f);
    float4 left = LARGER(x0, -half_width), right = LESSER(x0 + (float)(GSCL_TILE - 1), half_width);
    float slope = bounds[GSCL_BOUNDS_SLOPE], height2 = bounds[GSCL_BOUNDS_HEIGHT2], curve = bounds[GSCL_BOUNDS_CURVE];
    float4 top_dx = (float4)(bounds[GSCL_BOUNDS_SLOPE_X] * half_height), top = LARGER(top_dx, left),
           bottom = LARGER(-top_dx, left);
    top = LESSER(top, right);
    bottom = LESSER(bottom, right);
    float4 arc_top = height2 - curve * top * top, arc_bottom = height2 - curve * bottom * bottom;
    float4 high = slope * top + sqrt(LARGER(arc_top, zero)), low = slope * bottom - sqrt(LARGER(arc_bottom, zero));
    /* A little wider than exact, so that rounding loses no row; weights beyond the outline are 0. */
    float margin = 1e-3f * (1.0f + half_height) + 1e-6f * fabs(projected[GSCL_PROJECTED_Y]);
    /* Rows from the lower end of the tile for the first, from the upper for the last: truncation rounds down. */
    float4 height = (float4)(GSCL_TILE), from = height - (low - margin - y0), to = high + margin - y0 + 1.0f;
    from = LESSER(LARGER(from, zero), height);
    from = left > right ? zero : from; /* beside the outline */
    to = LESSER(LARGER(to, zero), height);
    vstore4(GSCL_TILE - convert_int4(from), 0, first);
    vstore4(convert_int4(to) - 1, 0, last);
}

bool box_touches_rows(int4 box, int first, int last) { return box.z <= last && box.w >= first && box.x <= box.y; }

/* The splats of a row's band, among which it finds its own. */
typedef struct {
    __global const int *list;
    int count;
} splat_source;

splat_source source_of_row(__global const int *restrict listed, __global const int *restrict listed_counts,
                           gscl_bin_settings t, int ty) {
    int band = ty / t.band_rows;
    splat_source source = {listed + (size_t)band * t.splats, listed_counts[band]};
    return source;
}

/* The tiles of row `ty` that a splat touches; none where first > last. */
int2 tiles_of_row(__global const float *restrict projected, __global const float *restrict ellipse_bounds,
                  __global const int4 *restrict boxes, size_t i, int ty) {
    int4 box = boxes[i];
    if (!box_touches_rows(box, ty, ty)) return (int2)(0, -1);
    return tiles_touched(projected + i * GSCL_PROJECTED, ellipse_bounds + i * GSCL_BOUNDS, box, ty);
}

#if BIN_ITEMS == 1
/* Lists the splats of a band of t.band_rows rows of tiles; returns how many. */
int list_band(__global const int4 *restrict boxes, gscl_bin_settings t, int band, __global int *restrict listed,
              __local long *restrict sums) {
    int first = band * t.band_rows, n = 0;
    for (int i = 0; i < t.splats; i++)
        if (box_touches_rows(boxes[i], first, first + t.band_rows - 1)) listed[n++] = i;
    return n;
}

/* Fills the lists of one row of tiles. */
__kernel GROUP_OF(BIN_ITEMS) void bin(__global const float *restrict projected,
                                      __global const float *restrict ellipse_bounds,
                                      __global const int4 *restrict boxes, __global const int *restrict listed,
                                      __global const int *restrict listed_counts,
                                      __global const gscl_link_grid *restrict grids, gscl_bin_settings t,
                                      __global uint *restrict entries, __global int2 *restrict tile_ranges,
                                      __global int *restrict row_totals, __global int *restrict links) {
    const int tiles_x = t.tiles_x, ty = (int)get_group_id(0);
    __global int2 *ranges = tile_ranges + (size_t)ty * tiles_x;
    splat_source source = source_of_row(listed, listed_counts, t, ty);
    for (int tx = 0; tx < tiles_x; tx++) ranges[tx] = (int2)(0, 0);
    for (int j = 0; j < source.count; j++) {
        int2 tiles = tiles_of_row(projected, ellipse_bounds, boxes, (size_t)source.list[j], ty);
        if (tiles.x > tiles.y) continue;
        ranges[tiles.x].x++; /* splats that begin at this tile */
        ranges[tiles.y].y++; /* splats that end at this tile */
    }
    /* Counts become the first entry of each tile; lists that would not fit are cut short below. */
    int total = 0, open = 0, base = ty * t.row_capacity, end = base + t.row_capacity;
    for (int tx = 0; tx < tiles_x; tx++) {
        int2 change = ranges[tx];
        ranges[tx] = (int2)(base + min(total, t.row_capacity));
        open += change.x;
        total += open;
        open -= change.y;
    }
    row_totals[ty] = total;
    for (int j = 0; j < source.count; j++) {
        size_t i = (size_t)source.list[j];
        int2 tiles = tiles_of_row(projected, ellipse_bounds, boxes, i, ty);
        for (int tx = tiles.x; tx <= tiles.y; tx += BIN_LANES) {
            int first[BIN_LANES], last[BIN_LANES];
            rows_touched(projected + i * GSCL_PROJECTED, ellipse_bounds + i * GSCL_BOUNDS, tx, ty, first, last);
            for (int k = 0; k < BIN_LANES && tx + k <= tiles.y; k++) {
                int to = ranges[tx + k].y;
                if (first[k] > last[k] || to >= end) continue;
                entries[to] = GSCL_ENTRY((uint)i, (uint)first[k], (uint)last[k]);
                link_entry(to, i, tx + k, ty, grids, links);
                ranges[tx + k].y = to + 1;
            }
        }
    }
}
#else
/* Neighbouring splats that a work-item looks at between two scans, whose barriers take longer. */
#define BAND_SPLATS 8

int list_band(__global const int4 *restrict boxes, gscl_bin_settings t, int band, __global int *restrict listed,
              __local long *restrict sums) {
    const int first = band * t.band_rows, last = first + t.band_rows - 1;
    int n = 0;
    for (int base = 0; base < t.splats; base += BAND_ITEMS * BAND_SPLATS) {
        const int from = base + (int)get_local_id(0) * BAND_SPLATS, count = min(t.splats - from, BAND_SPLATS);
        int touching = 0, own = 0; /* a bit of each, and how many */
        for (int k = 0; k < count; k++) {
            const int touches = box_touches_rows(boxes[from + k], first, last) ? 1 : 0;
            touching |= touches << k;
            own += touches;
        }
        int to = n + (int)group_scan(own, BAND_ITEMS, sums) - own;
        for (int k = 0; k < count; k++)
            if (touching >> k & 1) listed[to++] = from + k;
        n += (int)sums[BAND_ITEMS - 1];
        barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    }
    return n;
}

/* Counts the splats of each tile of row `ty`, of which `source` lists all.  `changes`: from each tile to the next. */
void count_row(__global const float *restrict projected, __global const float *restrict ellipse_bounds,
               __global const int4 *restrict boxes, gscl_bin_settings t, int ty, splat_source source,
               __global int *restrict tile_counts, __local int *restrict changes, __local long *restrict sums) {
    const int item = (int)get_local_id(0);
    int open = 0;
    for (int tx = item; tx < t.tiles_x; tx += BAND_ITEMS) changes[tx] = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int j = item; j < source.count; j += BAND_ITEMS) {
        int2 tiles = tiles_of_row(projected, ellipse_bounds, boxes, (size_t)source.list[j], ty);
        if (tiles.x > tiles.y) continue;
        atomic_add(changes + tiles.x, 1);
        if (tiles.y + 1 < t.tiles_x) atomic_add(changes + tiles.y + 1, -1);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int base = 0; base < t.tiles_x; base += BAND_ITEMS) {
        int tx = base + item, count = (int)group_scan(tx < t.tiles_x ? changes[tx] : 0, BAND_ITEMS, sums);
        if (tx < t.tiles_x) tile_counts[ty * t.tiles_x + tx] = open + count;
        open += (int)sums[BAND_ITEMS - 1];
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}

/* Whether a splat touches tile `tx` of row `ty`, as far as its ends within the row say. */
bool touches_tile(__global const float *restrict projected, __global const float *restrict ellipse_bounds,
                  __global const int4 *restrict boxes, size_t i, int tx, int ty) {
    int2 tiles = tiles_of_row(projected, ellipse_bounds, boxes, i, ty);
    return tx >= tiles.x && tx <= tiles.y;
}

/* Counts the splats of each tile where begin_lists did not.  One work-group per tile. */
__kernel GROUP_OF(BIN_ITEMS) void bin_count(__global const float *restrict projected,
                                            __global const float *restrict ellipse_bounds,
                                            __global const int4 *restrict boxes, __global const int *restrict listed,
                                            __global const int *restrict listed_counts, gscl_bin_settings t,
                                            __global int *restrict tile_counts) {
    __local long sums[BIN_ITEMS];
    const int tile = (int)get_group_id(0), tx = tile % t.tiles_x, ty = tile / t.tiles_x;
    splat_source source = source_of_row(listed, listed_counts, t, ty);
    int own = 0;
    for (int j = (int)get_local_id(0); j < source.count; j += BIN_ITEMS)
        own += touches_tile(projected, ellipse_bounds, boxes, (size_t)source.list[j], tx, ty) ? 1 : 0;
    group_scan(own, BIN_ITEMS, sums);
    if (get_local_id(0) == 0) tile_counts[tile] = (int)sums[BIN_ITEMS - 1];
}

/* Makes the entry of splat `i` in the list of a tile; false where it touches none of its rows. */
bool entry_of_tile(__global const float *restrict projected, __global const float *restrict ellipse_bounds,
                   __global const int4 *restrict boxes, size_t i, int tx, int ty, uint *restrict entry) {
    int first[BIN_LANES], last[BIN_LANES]; /* of this tile and those to its right, which have groups of their own */
    if (!touches_tile(projected, ellipse_bounds, boxes, i, tx, ty)) return false;
    rows_touched(projected + i * GSCL_PROJECTED, ellipse_bounds + i * GSCL_BOUNDS, tx, ty, first, last);
    *entry = GSCL_ENTRY((uint)i, (uint)first[0], (uint)last[0]);
    return first[0] <= last[0];
}

/* Fills the list of each tile behind those of the tiles to its left.  One work-group per tile; lists that would not fit
 * are cut short. */
__kernel GROUP_OF(BIN_ITEMS) void bin(__global const float *restrict projected,
                                      __global const float *restrict ellipse_bounds,
                                      __global const int4 *restrict boxes, __global const int *restrict listed,
                                      __global const int *restrict listed_counts,
                                      __global const gscl_link_grid *restrict grids, gscl_bin_settings t,
                                      __global const int *restrict tile_counts, __global uint *restrict entries,
                                      __global int2 *restrict tile_ranges, __global int *restrict row_totals,
                                      __global int *restrict links) {
    __local long sums[BIN_ITEMS];
    const int tile = (int)get_group_id(0), tx = tile % t.tiles_x, ty = tile / t.tiles_x, item = (int)get_local_id(0);
    const int base = ty * t.row_capacity, end = base + t.row_capacity;
    splat_source source = source_of_row(listed, listed_counts, t, ty);
    int before = 0;
    for (int i = item; i < tx; i += BIN_ITEMS) before += tile_counts[tile - tx + i];
    group_scan(before, BIN_ITEMS, sums);
    before = (int)sums[BIN_ITEMS - 1];
    const int begin = base + min(before, t.row_capacity);
    int next = begin;
    for (int start = 0; start < source.count; start += BIN_ITEMS) {
        size_t i = (size_t)source.list[min(start + item, source.count - 1)];
        uint entry = 0;
        bool touches =
            start + item < source.count && entry_of_tile(projected, ellipse_bounds, boxes, i, tx, ty, &entry);
        barrier(CLK_LOCAL_MEM_FENCE); /* all have read the last sum */
        int to = next + (int)group_scan(touches, BIN_ITEMS, sums) - 1;
        if (touches && to < end) {
            entries[to] = entry;
            link_entry(to, i, tx, ty, grids, links);
        }
        next = min(next + (int)sums[BIN_ITEMS - 1], end);
    }
    if (item > 0) return;
    tile_ranges[tile] = (int2)(begin, next);
    if (tx == t.tiles_x - 1) row_totals[ty] = before + tile_counts[tile];
}
#endif

/* Lists the splats of each band of t.band_rows rows of tiles, by `bands` work-groups; a list has room for t.splats.  On GPUs they
 * count those of each tile, too, unless tile_counts is NULL: bands are single rows then, of at most GSCL_COUNTED_TILES tiles.
 * Further work-groups number links. */
__kernel GROUP_OF(BAND_ITEMS) void begin_lists(__global const float *restrict projected,
                                               __global const float *restrict ellipse_bounds,
                                               __global const int4 *restrict boxes, gscl_bin_settings t, int bands,
                                               __global int *restrict listed, __global int *restrict listed_counts,
                                               __global int *restrict tile_counts, int block,
                                               __global const long *restrict block_links, int capacity,
                                               __global gscl_link_grid *restrict grids, __global int *restrict links,
                                               __global int *restrict needed) {
    __local long sums[BAND_ITEMS];
#if BIN_ITEMS > 1
    __local int changes[GSCL_COUNTED_TILES];
#endif
    const int group = (int)get_group_id(0);
    if (group >= bands) {
        number_links(group - bands, boxes, t.splats, block, block_links, capacity, grids, links, needed, sums);
        return;
    }
    splat_source source = {listed + (size_t)group * t.splats, 0};
    source.count = list_band(boxes, t, group, listed + (size_t)group * t.splats, sums);
    if (get_local_id(0) == 0) listed_counts[group] = source.count;
#if BIN_ITEMS > 1
    if (tile_counts) count_row(projected, ellipse_bounds, boxes, t, group, source, tile_counts, changes, sums);
#endif
}
