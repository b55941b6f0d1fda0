/* Binning: for every tile the ascending list of the splats whose outline touches it.
 *
 * One work-item per row of tiles goes over the splats in their order, so the lists come out sorted without
 * atomics and the same input always gives the same lists.  Each row of tiles owns `row_capacity`
 * entries.  Further entries are left out; the host reads their number from row_totals and grows the lists. */

/* Tiles of a row that are processed together. */
#define BIN_LANES 4

/* Rows of the tiles (tx, ty), (tx + 1, ty), ... that the outline touches: first and last; none where first > last. */
inline void rows_touched(__global const float *restrict projected, __global const float *restrict bounds, int tx,
                         int ty, int *restrict first, int *restrict last) {
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

/* Lists the splats whose box touches the rows of tiles from `first` to `last`; returns their number. */
inline int list_splats(__global const int4 *restrict boxes, int count, int first, int last,
                       __global int *restrict list) {
    int n = 0;
    for (int i = 0; i < count; i++) {
        int4 box = boxes[i];
        if (box.z <= last && box.w >= first && box.x <= box.y) list[n++] = i;
    }
    return n;
}

/* Lists the splats of each band of `band_rows` rows of tiles, so that not every row goes over all splats.  One
 * work-item per band; a list has room for `count` splats. */
__kernel void bin_bands(__global const int4 *restrict boxes, int count, int bands, int band_rows,
                        __global int *restrict listed, __global int *restrict listed_counts) {
    int band = (int)get_global_id(0), first = band * band_rows;
    if (band >= bands) return;
    listed_counts[band] = list_splats(boxes, count, first, first + band_rows - 1, listed + (size_t)band * count);
}

/* Fills the lists of one row of tiles. */
__kernel void bin(__global const float *restrict projected, __global const float *restrict ellipse_bounds,
                  __global const int4 *restrict boxes, __global int *restrict listed,
                  __global const int *restrict listed_counts, gscl_bin_settings t, __global uint *restrict entries,
                  __global int2 *restrict tile_ranges, __global int *restrict row_totals) {
    const int tiles_x = t.tiles_x;
    int ty = (int)get_global_id(0), band = t.band_rows > 0 ? ty / t.band_rows : ty;
    if (ty >= t.tiles_y) return;
    __global int2 *ranges = tile_ranges + (size_t)ty * tiles_x;
    __global int *list = listed + (size_t)band * t.splats;
    int listed_count = t.band_rows > 0 ? listed_counts[band] : list_splats(boxes, t.splats, ty, ty, list);
    for (int tx = 0; tx < tiles_x; tx++) ranges[tx] = (int2)(0, 0);
    for (int j = 0; j < listed_count; j++) {
        size_t i = (size_t)list[j];
        int4 box = boxes[i];
        if (ty < box.z || ty > box.w) continue;
        int2 tiles = tiles_touched(projected + i * GSCL_PROJECTED, ellipse_bounds + i * GSCL_BOUNDS, box, ty, 1.0f);
        ranges[tiles.x].x++; /* splats that begin at this tile */
        ranges[tiles.y].y++; /* splats that end at this tile */
    }
    /* Counts become the first entry of each tile; lists that would not fit are cut short below. */
    int total = 0, open = 0, base = ty * t.row_capacity, end = base + t.row_capacity;
    for (int tx = 0; tx < tiles_x; tx++) {
        int2 change = ranges[tx];
        ranges[tx] = (int2)(min(base + total, end));
        open += change.x;
        total += open;
        open -= change.y;
    }
    row_totals[ty] = total;
    for (int j = 0; j < listed_count; j++) {
        size_t i = (size_t)list[j];
        int4 box = boxes[i];
        if (ty < box.z || ty > box.w) continue;
        __global const float *record = projected + i * GSCL_PROJECTED, *bounds = ellipse_bounds + i * GSCL_BOUNDS;
        int2 tiles = tiles_touched(record, bounds, box, ty, 1.0f);
        for (int tx = tiles.x; tx <= tiles.y; tx += BIN_LANES) {
            int first[BIN_LANES], last[BIN_LANES];
            rows_touched(record, bounds, tx, ty, first, last);
            for (int k = 0; k < BIN_LANES && tx + k <= tiles.y; k++)
                if (first[k] <= last[k] && ranges[tx + k].y < end)
                    entries[ranges[tx + k].y++] = GSCL_ENTRY((uint)i, (uint)first[k], (uint)last[k]);
        }
    }
}
