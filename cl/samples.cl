/* Drawing straight into the samples of an image in memory: clamped, straight or premultiplied, interleaved. */

/* Stores `count` values of one channel, `stride` samples apart. */
void store_samples(pix value, int sample, __global uchar *restrict to, size_t first, int stride, int count) {
    float values[LANES];
    if (sample == GSCL_SAMPLE_KIND_U8) value = value * 255.0f + 0.5f;
    if (sample == GSCL_SAMPLE_KIND_U16) value = value * 65535.0f + 0.5f;
    PIX_STORE(value, values);
    for (int i = 0; i < count; i++) {
        size_t at = first + (size_t)(i * stride);
        if (sample == GSCL_SAMPLE_KIND_U8) to[at] = (uchar)values[i];
        else if (sample == GSCL_SAMPLE_KIND_U16) ((__global ushort *)to)[at] = (ushort)values[i];
        else ((__global float *)to)[at] = values[i];
    }
}

#if COLOURS == 3 && !ALPHA_CHANNEL && LANES == 16
/* 16 pixels of 8-bit RGB: the most frequent case. */
void store_rgb8(const pix *values, __global uchar *restrict to) {
    uchar16 r = convert_uchar16(values[0] * 255.0f + 0.5f), g = convert_uchar16(values[1] * 255.0f + 0.5f),
            b = convert_uchar16(values[2] * 255.0f + 0.5f);
    vstore16((uchar16)(r.s0, g.s0, b.s0, r.s1, g.s1, b.s1, r.s2, g.s2, b.s2, r.s3, g.s3, b.s3, r.s4, g.s4, b.s4, r.s5),
             0, to);
    vstore16((uchar16)(g.s5, b.s5, r.s6, g.s6, b.s6, r.s7, g.s7, b.s7, r.s8, g.s8, b.s8, r.s9, g.s9, b.s9, r.sa, g.sa),
             1, to);
    vstore16((uchar16)(b.sa, r.sb, g.sb, b.sb, r.sc, g.sc, b.sc, r.sd, g.sd, b.sd, r.se, g.se, b.se, r.sf, g.sf, b.sf),
             2, to);
}
#endif

/* Stores `count` pixels, given as vectors of each channel, from pixel `first` of the image on. */
ALWAYS_INLINE void store_pixels(pix *values, gscl_sample_layout layout, __global uchar *samples, size_t first,
                                int count) {
    int colours = layout.channels >= 3 ? 3 : 1;
    size_t to = first * layout.channels;
    pix alpha = (pix)(1.0f);
    UNROLL
    for (int k = 0; k < CHANNELS; k++) values[k] = clamp(values[k], 0.0f, 1.0f);
#if COLOURS == 3 && !ALPHA_CHANNEL && LANES == 16
    if (layout.sample == GSCL_SAMPLE_KIND_U8 && layout.channels == 3 && count >= LANES) {
        store_rgb8(values, samples + to);
        return;
    }
#endif
#if ALPHA_CHANNEL
    alpha = values[COLOURS];
    UNROLL
    for (int k = 0; k < COLOURS; k++) {
        values[k] = fmin(values[k], alpha);
        if (!layout.premultiplied) values[k] = select((pix)(0.0f), values[k] / alpha, alpha > (pix)(0.0f));
    }
#endif
    for (int k = 0; k < colours; k++)
        store_samples(values[COLOURS == 3 ? k : 0], layout.sample, samples, to + k, layout.channels, count);
    if (layout.channels == 2 || layout.channels == 4)
        store_samples(alpha, layout.sample, samples, to + colours, layout.channels, count);
}

/* Like raster_forward, into an image in memory with packed rows. */
__kernel GROUP_OF(ITEMS) void raster_samples(__global const float *restrict splats,
                                             __global const uint *restrict entries,
                                             __global const int2 *restrict tile_ranges, __constant float *background,
                                             gscl_image_shape shape, gscl_sample_layout layout,
                                             __global uchar *restrict samples) {
    pixel_block p = pixel_block_of(get_group_id(0), shape);
    canvas c;
    canvas_draw(&c, p, splats, entries, tile_ranges[p.tile], background);
    if (p.lanes <= 0) return;
    for (int r = 0; r < p.rows; r++) {
        pix values[CHANNELS];
        UNROLL
        for (int k = 0; k < CHANNELS; k++) values[k] = c.colour[k][r];
        store_pixels(values, layout, samples, (size_t)(p.y + r) * shape.width + p.x, min(p.lanes, LANES));
    }
}
