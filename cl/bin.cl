/* Binning: for every tile the ascending list of the splats whose outline touches it.
 *
 * One work-item per row of tiles walks all splats in their order, so the lists come out sorted without
 * atomics and the same input always gives the same lists.  Each row of tiles owns `row_capacity`
 * entries; what does not fit is left out and row_totals tells the host, which then grows the lists. */

/* Rows (packed as in GSCL_ENTRY, without the splat) of tile (tx, ty) that the outline touches, or -1. */
inline int rows_touched(__global const float *restrict drawn, __global const float *restrict extent, int tx, int ty) {
    float x0 = (float)(tx * GSCL_TILE) + 0.5f - drawn[GSCL_DRAWN_X];
    float y0 = (float)(ty * GSCL_TILE) + 0.5f - drawn[GSCL_DRAWN_Y];
    float half_width = extent[GSCL_EXTENT_HALF_WIDTH];
    float left = fmax(x0, -half_width), right = fmin(x0 + (GSCL_TILE - 1), half_width);
    if (left > right) return -1;
    float slope = extent[GSCL_EXTENT_SLOPE], height2 = extent[GSCL_EXTENT_HEIGHT2], curve = extent[GSCL_EXTENT_CURVE];
    float top = clamp(extent[GSCL_EXTENT_TOP_DX], left, right),
          bottom = clamp(-extent[GSCL_EXTENT_TOP_DX], left, right);
    float high = slope * top + sqrt(fmax(height2 - curve * top * top, 0.0f));
    float low = slope * bottom - sqrt(fmax(height2 - curve * bottom * bottom, 0.0f));
    /* A little wider than exact: rounding must not lose a row; weights beyond the outline are 0 anyway. */
    float margin = 1e-3f * (1.0f + extent[GSCL_EXTENT_HALF_HEIGHT]) + 1e-6f * fabs(drawn[GSCL_DRAWN_Y]);
    float first = fmax(ceil(low - margin - y0), 0.0f), last = fmin(floor(high + margin - y0), (float)(GSCL_TILE - 1));
    if (!(first <= last)) return -1;
    return (int)GSCL_ENTRY(0u, (uint)first, (uint)last);
}

__kernel void bin(__global const float *restrict drawn, __global const float *restrict extents,
                  __global const int4 *restrict boxes, int count, int tiles_x, int tiles_y, int row_capacity,
                  __global uint *restrict entries, __global int2 *restrict tile_ranges,
                  __global int *restrict row_totals) {
    int ty = (int)get_global_id(0);
    if (ty >= tiles_y) return;
    __global int2 *ranges = tile_ranges + (size_t)ty * tiles_x;
    for (int tx = 0; tx < tiles_x; tx++) ranges[tx] = (int2)(0, 0);
    for (int i = 0; i < count; i++) {
        int4 box = boxes[i];
        if (ty < box.z || ty > box.w) continue;
        for (int tx = box.x; tx <= box.y; tx++) ranges[tx].y++;
    }
    /* Counts become the first entry of each tile; lists that would not fit are cut short below. */
    int total = 0, base = ty * row_capacity, end = base + row_capacity;
    for (int tx = 0; tx < tiles_x; tx++) {
        int n = ranges[tx].y;
        ranges[tx] = (int2)(min(base + total, end));
        total += n;
    }
    row_totals[ty] = total;
    for (int i = 0; i < count; i++) {
        int4 box = boxes[i];
        if (ty < box.z || ty > box.w) continue;
        for (int tx = box.x; tx <= box.y; tx++) {
            int rows = rows_touched(drawn + (size_t)i * GSCL_DRAWN, extents + (size_t)i * GSCL_EXTENT, tx, ty);
            if (rows >= 0 && ranges[tx].y < end) entries[ranges[tx].y++] = GSCL_ENTRY((uint)i, 0u, (uint)rows);
        }
    }
}
