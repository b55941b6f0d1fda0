/* Binning: for every tile the ascending list of the splats whose outline touches it.
 *
 * One work-item per row of tiles walks the splats in their order, so the lists come out sorted without
 * atomics and the same input always gives the same lists.  Each row of tiles owns `row_capacity`
 * entries; what does not fit is left out and row_totals tells the host, which then grows the lists. */

/* Tiles of a row that are looked at together. */
#define ABREAST 4

/* Rows of the tiles (tx, ty), (tx + 1, ty), ... that the outline touches: first and last, no rows where first > last. */
inline void rows_touched(__global const float *restrict drawn, __global const float *restrict extent, int tx, int ty,
                         int *restrict first, int *restrict last) {
    float4 x0 =
        (float4)(0, GSCL_TILE, 2 * GSCL_TILE, 3 * GSCL_TILE) + ((float)(tx * GSCL_TILE) + 0.5f - drawn[GSCL_DRAWN_X]);
    float y0 = (float)(ty * GSCL_TILE) + 0.5f - drawn[GSCL_DRAWN_Y];
    float half_width = extent[GSCL_EXTENT_HALF_WIDTH];
    float4 left = fmax(x0, -half_width), right = fmin(x0 + (float)(GSCL_TILE - 1), half_width);
    float slope = extent[GSCL_EXTENT_SLOPE], height2 = extent[GSCL_EXTENT_HEIGHT2], curve = extent[GSCL_EXTENT_CURVE];
    float top_dx = extent[GSCL_EXTENT_SLOPE_X] * extent[GSCL_EXTENT_HALF_HEIGHT];
    float4 top = fmin(fmax((float4)(top_dx), left), right), bottom = fmin(fmax((float4)(-top_dx), left), right);
    float4 high = slope * top + sqrt(fmax(height2 - curve * top * top, 0.0f));
    float4 low = slope * bottom - sqrt(fmax(height2 - curve * bottom * bottom, 0.0f));
    /* A little wider than exact: rounding must not lose a row; weights beyond the outline are 0 anyway. */
    float margin = 1e-3f * (1.0f + extent[GSCL_EXTENT_HALF_HEIGHT]) + 1e-6f * fabs(drawn[GSCL_DRAWN_Y]);
    float4 from = fmax(ceil(low - margin - y0), 0.0f), to = fmin(floor(high + margin - y0), (float)(GSCL_TILE - 1));
    from = select(from, (float4)(GSCL_TILE), isgreater(left, right)); /* beside the outline */
    vstore4(convert_int4(fmin(from, (float)GSCL_TILE)), 0, first);
    vstore4(convert_int4(fmax(to, -1.0f)), 0, last);
}

/* Rows of tiles share the walk over all splats: each band of rows lists those whose box touches it.  One work-item a
 * band, `count` places each. */
__kernel void bin_bands(__global const int4 *restrict boxes, int count, int bands, int band_rows,
                        __global int *restrict listed, __global int *restrict listed_counts) {
    int band = (int)get_global_id(0), n = 0;
    if (band >= bands) return;
    int first = band * band_rows, last = first + band_rows - 1;
    __global int *list = listed + (size_t)band * count;
    for (int i = 0; i < count; i++) {
        int4 box = boxes[i];
        list[n] = i; /* n <= i */
        n += box.z <= last && box.w >= first && box.x <= box.y;
    }
    listed_counts[band] = n;
}

__kernel void bin(__global const float *restrict drawn, __global const float *restrict extents,
                  __global const int4 *restrict boxes, int count, __global const int *restrict listed,
                  __global const int *restrict listed_counts, int band_rows, int tiles_x, int tiles_y, int row_capacity,
                  __global uint *restrict entries, __global int2 *restrict tile_ranges,
                  __global int *restrict row_totals) {
    int ty = (int)get_global_id(0);
    if (ty >= tiles_y) return;
    __global int2 *ranges = tile_ranges + (size_t)ty * tiles_x;
    __global const int *list = listed + (size_t)(ty / band_rows) * count;
    int listed_count = listed_counts[ty / band_rows];
    for (int tx = 0; tx < tiles_x; tx++) ranges[tx] = (int2)(0, 0);
    for (int j = 0; j < listed_count; j++) {
        size_t i = (size_t)list[j];
        int4 box = boxes[i];
        if (ty < box.z || ty > box.w) continue;
        int2 tiles = tiles_touched(drawn + i * GSCL_DRAWN, extents + i * GSCL_EXTENT, box, ty, 1.0f);
        for (int tx = tiles.x; tx <= tiles.y; tx++) ranges[tx].y++;
    }
    /* Counts become the first entry of each tile; lists that would not fit are cut short below. */
    int total = 0, base = ty * row_capacity, end = base + row_capacity;
    for (int tx = 0; tx < tiles_x; tx++) {
        int n = ranges[tx].y;
        ranges[tx] = (int2)(min(base + total, end));
        total += n;
    }
    row_totals[ty] = total;
    for (int j = 0; j < listed_count; j++) {
        size_t i = (size_t)list[j];
        int4 box = boxes[i];
        if (ty < box.z || ty > box.w) continue;
        __global const float *record = drawn + i * GSCL_DRAWN, *extent = extents + i * GSCL_EXTENT;
        int2 tiles = tiles_touched(record, extent, box, ty, 1.0f);
        for (int tx = tiles.x; tx <= tiles.y; tx += ABREAST) {
            int first[ABREAST], last[ABREAST];
            rows_touched(record, extent, tx, ty, first, last);
            for (int k = 0; k < ABREAST && tx + k <= tiles.y; k++)
                if (first[k] <= last[k] && ranges[tx + k].y < end)
                    entries[ranges[tx + k].y++] = GSCL_ENTRY((uint)i, (uint)first[k], (uint)last[k]);
        }
    }
}
