/* From planes to the samples of an image in memory: clamped, straight or premultiplied, interleaved. */

#define SAMPLE_U8 1 /* gscl_sample */
#define SAMPLE_U16 2

/* What becomes of a pixel (mirrors gscl_sample_layout in host/lib/render.h). */
typedef struct {
    int channels; /* of the image: 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA */
    int sample;
    int premultiplied;
} sample_layout;

/* Stores `count` values of one channel, `stride` samples apart. */
inline void store_samples(pix value, int sample, __global uchar *restrict to, size_t first, int stride, int count) {
    float values[LANES];
    if (sample == SAMPLE_U8) value = value * 255.0f + 0.5f;
    if (sample == SAMPLE_U16) value = value * 65535.0f + 0.5f;
    PIX_STORE(value, values);
    for (int i = 0; i < count; i++) {
        size_t at = first + (size_t)(i * stride);
        if (sample == SAMPLE_U8) to[at] = (uchar)values[i];
        else if (sample == SAMPLE_U16) ((__global ushort *)to)[at] = (ushort)values[i];
        else ((__global float *)to)[at] = values[i];
    }
}

/* A clamped vector of plane k. */
inline pix plane_values(__global const float *restrict planes, int k, ulong plane, size_t from, int count) {
    return clamp(pix_load_clipped(planes + k * plane + from, count), 0.0f, 1.0f);
}

#if COLOURS == 3 && !ALPHA_CHANNEL && LANES == 16
/* What most pictures are: 16 pixels of 8-bit RGB. */
inline void store_rgb8(pix red, pix green, pix blue, __global uchar *restrict to) {
    uchar16 r = convert_uchar16(red * 255.0f + 0.5f), g = convert_uchar16(green * 255.0f + 0.5f),
            b = convert_uchar16(blue * 255.0f + 0.5f);
    vstore16((uchar16)(r.s0, g.s0, b.s0, r.s1, g.s1, b.s1, r.s2, g.s2, b.s2, r.s3, g.s3, b.s3, r.s4, g.s4, b.s4, r.s5),
             0, to);
    vstore16((uchar16)(g.s5, b.s5, r.s6, g.s6, b.s6, r.s7, g.s7, b.s7, r.s8, g.s8, b.s8, r.s9, g.s9, b.s9, r.sa, g.sa),
             1, to);
    vstore16((uchar16)(b.sa, r.sb, g.sb, b.sb, r.sc, g.sc, b.sc, r.sd, g.sd, b.sd, r.se, g.se, b.se, r.sf, g.sf, b.sf),
             2, to);
}
#endif

/* One work-item: LANES pixels of a row. */
__kernel void to_samples(__global const float *restrict planes, int width, int rows, ulong plane, sample_layout layout,
                         __global uchar *restrict samples) {
    int chunks = (width + LANES - 1) / LANES, i = (int)get_global_id(0);
    int x = i % chunks * LANES, y = i / chunks;
    if (y >= rows) return;
    int count = min(width - x, LANES), colours = layout.channels >= 3 ? 3 : 1;
    size_t from = (size_t)y * width + x, to = from * layout.channels;
#if COLOURS == 3 && !ALPHA_CHANNEL && LANES == 16
    if (layout.sample == SAMPLE_U8 && layout.channels == 3 && count == LANES) {
        store_rgb8(plane_values(planes, 0, plane, from, LANES), plane_values(planes, 1, plane, from, LANES),
                   plane_values(planes, 2, plane, from, LANES), samples + to);
        return;
    }
#endif
    pix alpha = (pix)(1.0f);
#if ALPHA_CHANNEL
    alpha = plane_values(planes, COLOURS, plane, from, count);
#endif
    for (int k = 0; k < colours; k++) {
        pix c = plane_values(planes, COLOURS == 3 ? k : 0, plane, from, count);
#if ALPHA_CHANNEL
        c = fmin(c, alpha);
        if (!layout.premultiplied) c = select((pix)(0.0f), c / alpha, alpha > (pix)(0.0f));
#endif
        store_samples(c, layout.sample, samples, to + k, layout.channels, count);
    }
    if (layout.channels == 2 || layout.channels == 4)
        store_samples(alpha, layout.sample, samples, to + colours, layout.channels, count);
}
