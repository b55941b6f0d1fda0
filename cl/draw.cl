/* Drawing an image of splats. */

/* Draws all tiles into CHANNELS planes. */
__kernel GROUP_OF(ITEMS) void raster_forward(__global const real *restrict splats,
                                             __global const uint *restrict entries,
                                             __global const int2 *restrict tile_ranges, __constant float *background,
                                             __global real *restrict image, gscl_image_shape shape) {
    pixel_block p = pixel_block_of(get_group_id(0), shape);
    const size_t plane = plane_size(shape);
    canvas c;
    canvas_draw(&c, p, splats, entries, tile_ranges[p.tile], background);
    for (int r = 0; r < p.rows; r++) UNROLL
    for (int k = 0; k < CHANNELS; k++)
        pix_store_clipped(c.colour[k][r], image + k * plane + (size_t)(p.y + r) * shape.width + p.x, p.lanes);
}
