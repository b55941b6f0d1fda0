/* The visual loss: the sum of errors in luma of SSIMULACRA 2.1 (https://github.com/cloudinary/ssimulacra2), its derivative
 * by the rendering, and a local quadratic model of it.
 *
 * At each scale, halved in linear light, the luma of both images is compared by three maps:
 *     d = max(0, 1 - (1 - (m - n)^2) (2 cov + C) / (A + B + C))      structure
 *     e = (1 + |y - n|) / (1 + |x - m|) - 1                          artefacts where e > 0, lost detail where e < 0
 *     y - x                                                          error
 * with the target x, the rendering y, their local means m and n, variances A and B and covariance under a Gaussian
 * window of sigma 1.5.  The image has zeros beyond its border.  The loss is a sum of weights times the mean and times
 * the 4-norm, (mean v^4)^(1/4), of the first three maps, and of the 6-norm of the error, which lies near its largest
 * values: they are what Butteraugli sees, and SSIMULACRA 2 does not.
 *
 * Luma is the cube root of luminance here, where SSIMULACRA 2 has the mean of the cube roots of two cones' responses,
 * whose mean is luminance: they differ by 0.2 % in pure red and less in other colours.
 *
 * The quadratic model is squared error against the target plus w times the squared error of luma against a target of
 * its own, at each pixel, such that the derivative by equal changes of all colours is that of the loss at the present
 * rendering.  The curvature w is that of d, proportional to 1 / (A + B + C) under the windows, of e, proportional to
 * 1 / |e|, and of the error.  It holds for changes that are the same over a window or finer; for others it is too large.
 *
 * Padded planes here have rows of `stride` floats, GSCL_SSIM_MARGIN zeros on each side, as in ssim.cl; plain ones have
 * none.  Those of all scales lie in one buffer, the largest scale first: all planes of one scale, then those of the next.
 *
 * Kernels whose name ends in _row take a row of a scale as a work-group, of one work-item on CPUs: those of all scales in one
 * launch.  Those that end in _strip take a row of the smallest scale as a work-group, with all rows of larger scales that
 * it was made from, and compute one scale after the other.  A work-item of the others takes LANES pixels. */
#define TAPS 9
#define MARGIN GSCL_SSIM_MARGIN
#define HALF_WINDOW (TAPS / 2)
#define C2 9e-4f
#define MIN_DIFFERENCE 0.02f  /* smallest |e| in the curvature of lost detail and artefacts */
#define PEAK_CURVATURE 3.0f   /* of the 6-norm in the model: 1 costs 2.7 points of SSIMULACRA 2, 6 and 12 half of one */
#define MIN_LUMA_WEIGHT 1e-3f /* of the model, where squared error has the weight 1 */

/* The response of the recursive filter of SSIMULACRA 2, a Gaussian of sigma 1.5. */
__constant float window[TAPS] = {0.00941436781f, 0.0360111147f, 0.109335373f,  0.212928592f,  0.264621105f,
                                 0.212928592f,   0.109335373f,  0.0360111147f, 0.00941436781f};
/* Luma of black is 0.01. */
#define CONE_BIAS 0.00379307325f
#define LUMA_OFFSET (0.01f - 0.155954188f) /* less the cube root of the bias */

/* sRGB to linear light for 0.04045 <= s <= 1: a polynomial, error below 8e-7; and its derivative. */
pix linear_of(pix s) {
    s = clamp(s, (pix)(0.0f), (pix)(1.0f));
    pix p = fma((pix)(-0.0693649246f), s, (pix)(0.344726035f));
    p = fma(p, s, (pix)(-0.748934319f));
    p = fma(p, s, (pix)(0.95905803f));
    p = fma(p, s, (pix)(-0.869963428f));
    p = fma(p, s, (pix)(0.862865068f));
    p = fma(p, s, (pix)(0.485476532f));
    p = fma(p, s, (pix)(0.0352814211f));
    p = fma(p, s, (pix)(0.000855218992f));
    return select(p, s * (1.0f / 12.92f), s < (pix)(0.04045f));
}
pix linear_slope(pix s) {
    pix p = fma((pix)(-0.554919397f), s, (pix)(2.413082245f));
    p = fma(p, s, (pix)(-4.493605914f));
    p = fma(p, s, (pix)(4.79529015f));
    p = fma(p, s, (pix)(-3.479853712f));
    p = fma(p, s, (pix)(2.588595204f));
    p = fma(p, s, (pix)(0.970953064f));
    p = fma(p, s, (pix)(0.0352814211f));
    p = select(p, (pix)(1.0f / 12.92f), s < (pix)(0.04045f));
    return select(p, (pix)(0.0f), s < (pix)(0.0f) || s > (pix)(1.0f));
}

/* Cube root of 0.003..1.1: a guess from the bits, then two steps of Halley's method.  Relative error below 3e-7. */
pix cube_root(pix x) {
    pix r = PIX_OF_BITS(PIX_INT(fma(PIX_FLOAT(PIX_BITS(x)), (pix)(1.0f / 3.0f), (pix)(709958130.0f))));
    for (int i = 0; i < 2; i++) {
        pix cube = r * r * r;
        r *= (cube + 2.0f * x) / (2.0f * cube + x);
    }
    return r;
}

/* Index of a pixel in a padded plane, and the size of one. */
size_t padded_at(gscl_visual_scale s, int x, int y) { return (size_t)(y + MARGIN) * s.stride + x + MARGIN; }
size_t padded_plane(gscl_visual_scale s) { return (size_t)s.stride * (s.height + 2 * MARGIN); }
size_t plain_plane(gscl_visual_scale s) { return (size_t)s.width * s.height; }
size_t plain_at(gscl_visual_scale s, int x, int y) { return (size_t)y * s.width + x; }

/* A scale by its number. */
gscl_visual_scale scale_of(gscl_visual_scales t, int k) {
    /* Constants, because Mesa's compiler fails on a run-time index into a struct that was passed by value. */
    return k == 0 ? t.scale[0] : k == 1 ? t.scale[1] : t.scale[2];
}

/* The scale of row *y of those of all scales; *y becomes the row within it. */
gscl_visual_scale scale_of_row(gscl_visual_scales t, int *y) {
    int k = 0;
    for (; k < t.count - 1 && *y >= scale_of(t, k).height; k++) *y -= scale_of(t, k).height;
    return scale_of(t, k);
}

/* The rows of all scales that are larger than scale `k`. */
int rows_before(gscl_visual_scales t, int k) {
    int rows = 0;
    for (int i = 0; i < k; i++) rows += scale_of(t, i).height;
    return rows;
}

/* The rows of scale `k` that row `strip` of the smallest scale was made from: first, and behind the last. */
int2 rows_of_strip(gscl_visual_scales t, int k, int strip) {
    int halvings = t.count - 1 - k;
    return (int2)(strip << halvings, min((strip + 1) << halvings, scale_of(t, k).height));
}

/* The first pixels of the vectors of a row of scale `s` that are this work-item's. */
#define FOR_VECTORS(x, s) for (int x = (int)get_local_id(0) * LANES; x < (s).width; x += (int)get_local_size(0) * LANES)

/* First pixel and row of a work-item; false beyond the end. */
bool visual_position(size_t item, gscl_visual_scale s, int *x, int *y) {
    int chunks = (s.width + LANES - 1) / LANES, i = (int)item;
    *x = i % chunks * LANES;
    *y = i / chunks;
    return *y < s.height;
}

/* The luminance of pixels of sRGB planes. */
pix luminance_of(__global const float *restrict planes, size_t plane) {
    pix sum = (pix)(0.0f);
    UNROLL
    for (int k = 0; k < COLOURS; k++) sum = fma((pix)(luma_share(k)), linear_of(PIX_LOAD(planes + k * plane)), sum);
    return sum;
}

__kernel GROUP_OF(CHUNK_ITEMS) void visual_luminance(__global const float *restrict planes, gscl_visual_scale s,
                                                     __global float *restrict luminance) {
    int x, y;
    if (!visual_position(get_global_id(0), s, &x, &y)) return;
    size_t at = plain_at(s, x, y);
    pix_store_clipped(luminance_of(planes + at, plain_plane(s)), luminance + at, s.width - x);
}

/* Likewise, halved: the mean of 2x2 pixels; an odd last row or column counts twice.  `s`: the half size. */
__kernel GROUP_OF(CHUNK_ITEMS) void visual_luminance_half(__global const float *restrict planes, int width, int height,
                                                          gscl_visual_scale s, __global float *restrict luminance) {
    int x, y;
    if (!visual_position(get_global_id(0), s, &x, &y)) return;
    size_t plane = (size_t)width * height;
    float sums[2 * LANES], halved[LANES];
    for (int i = 0; i < 2; i++) { /* two vectors of two rows each */
        int left = 2 * x + i * LANES;
        __global const float *row = planes + (size_t)(2 * y) * width + left;
        pix sum = (pix)(0.0f);
        if (left < width) {
            sum = luminance_of(row, plane);
            sum += 2 * y + 1 < height ? luminance_of(row + width, plane) : sum;
        }
        PIX_STORE(sum, sums + i * LANES);
    }
    int last = width - 1 - 2 * x;
    if (last % 2 == 0 && last < 2 * LANES) sums[last + 1] = sums[last];
    for (int i = 0; i < LANES; i++) halved[i] = 0.25f * (sums[2 * i] + sums[2 * i + 1]);
    pix_store_clipped(PIX_LOAD(halved), luminance + plain_at(s, x, y), s.width - x);
}

/* Halves the luminance of the largest scale down to the smallest: a plain plane of each. */
__kernel GROUP_OF(SUM_ITEMS) void visual_halve_strip(gscl_visual_scales t, __global float *restrict luminance) {
    for (int k = 1; k < t.count; k++) {
        gscl_visual_scale s = scale_of(t, k - 1), half_size = scale_of(t, k);
        const int2 rows = rows_of_strip(t, k, (int)get_group_id(0));
        for (int y = rows.x; y < rows.y; y++) {
            __global const float *row0 = luminance + s.before + plain_at(s, 0, 2 * y);
            __global const float *row1 = luminance + s.before + plain_at(s, 0, min(2 * y + 1, s.height - 1));
            __global float *to = luminance + half_size.before + plain_at(half_size, 0, y);
            for (int x = (int)get_local_id(0); x < half_size.width; x += (int)get_local_size(0)) {
                int x0 = 2 * x, x1 = min(2 * x + 1, s.width - 1); /* an odd last row or column counts twice */
                to[x] = 0.25f * ((row0[x0] + row0[x1]) + (row1[x0] + row1[x1]));
            }
        }
        barrier(CLK_GLOBAL_MEM_FENCE);
    }
}

/* Horizontal sums of y, y y and x y of padded planes: three padded planes. */
void blur_luma(__global const float *rendering, __global const float *target, gscl_visual_scale s, int x, int y,
               __global float *rows) {
    size_t at = padded_at(s, x, y), plane = padded_plane(s);
    pix m[3] = {(pix)(0.0f), (pix)(0.0f), (pix)(0.0f)};
    for (int t = 0; t < TAPS; t++) {
        pix a = PIX_LOAD(rendering + at + t - HALF_WINDOW);
        pix b = PIX_LOAD(target + at + t - HALF_WINDOW);
        pix wa = window[t] * a;
        m[0] += wa;
        m[1] = fma(wa, a, m[1]);
        m[2] = fma(wa, b, m[2]);
    }
    for (int j = 0; j < 3; j++) pix_store_clipped(m[j], rows + j * plane + at, s.width - x);
}

/* Luminance to luma, a padded plane, and the horizontal sums of it and of `target`, which may be the same plane. */
__kernel GROUP_OF(SUM_ITEMS) void visual_luma_row(__global const float *restrict luminance, gscl_visual_scales t,
                                                  __global float *luma, __global const float *target,
                                                  __global float *restrict rows) {
    int y = (int)get_group_id(0);
    gscl_visual_scale s = scale_of_row(t, &y);
    luma += s.padded_before;
    FOR_VECTORS(x, s) {
        pix value = cube_root(PIX_LOAD(luminance + s.before + plain_at(s, x, y)) + CONE_BIAS) + LUMA_OFFSET;
        pix_store_clipped(value, luma + padded_at(s, x, y), s.width - x);
    }
    barrier(CLK_GLOBAL_MEM_FENCE);
    FOR_VECTORS(x, s) blur_luma(luma, target + s.padded_before, s, x, y, rows + 4 * (size_t)s.padded_before);
}

/* Vertical sums of padded planes. */
pix column_sum(__global const float *restrict rows, size_t at, int stride) {
    pix sum = (pix)(0.0f);
    for (int t = 0; t < TAPS; t++)
        sum = fma((pix)(window[t]), PIX_LOAD(rows + at + (size_t)t * stride - (size_t)HALF_WINDOW * stride), sum);
    return sum;
}

/* The target's mean and variance: two plain planes, from visual_luma_row of the target with itself. */
__kernel GROUP_OF(SUM_ITEMS) void visual_statistics_row(__global const float *restrict rows, gscl_visual_scales t,
                                                        __global float *restrict statistics) {
    int y = (int)get_group_id(0);
    gscl_visual_scale s = scale_of_row(t, &y);
    rows += 4 * (size_t)s.padded_before;
    statistics += 2 * (size_t)s.before;
    FOR_VECTORS(x, s) {
        size_t at = padded_at(s, x, y), to = plain_at(s, x, y);
        pix mean = column_sum(rows, at, s.stride), square = column_sum(rows + padded_plane(s), at, s.stride);
        pix_store_clipped(mean, statistics + to, s.width - x);
        pix_store_clipped(square - mean * mean, statistics + plain_plane(s) + to, s.width - x);
    }
}

/* One vector of pixels: the three maps, and what their derivatives need. */
typedef struct {
    pix x, y, mean_x, mean_y;            /* target, rendering and their local means */
    pix luminance, structure, variances; /* d = 1 - luminance * structure; A + B + C */
    pix d, e;
} visual_terms;

visual_terms terms_of(__global const float *restrict moments, __global const float *restrict statistics,
                      __global const float *restrict rendering, __global const float *restrict target,
                      gscl_visual_scale s, int x, int y) {
    size_t at = plain_at(s, x, y), plane = plain_plane(s), padded = padded_at(s, x, y);
    visual_terms t;
    t.x = PIX_LOAD(target + padded);
    t.y = PIX_LOAD(rendering + padded);
    t.mean_x = PIX_LOAD(statistics + at);
    t.mean_y = PIX_LOAD(moments + at);
    pix difference = t.mean_x - t.mean_y;
    t.luminance = fma(-difference, difference, (pix)(1.0f));
    t.variances =
        PIX_LOAD(statistics + plane + at) + (PIX_LOAD(moments + plane + at) - t.mean_y * t.mean_y) + (pix)(C2);
    t.structure = fma((pix)(2.0f), PIX_LOAD(moments + 2 * plane + at) - t.mean_x * t.mean_y, (pix)(C2)) / t.variances;
    t.d = fmax(1.0f - t.luminance * t.structure, (pix)(0.0f));
    t.e = (1.0f + fabs(t.y - t.mean_y)) / (1.0f + fabs(t.x - t.mean_x)) - 1.0f;
    return t;
}

/* Finishes the moments of a row (three plain planes) and adds up its terms: GSCL_VISUAL_SUMS sums. */
__kernel GROUP_OF(SUM_ITEMS) void visual_terms_row(__global const float *restrict rows,
                                                   __global const float *restrict statistics,
                                                   __global const float *restrict rendering,
                                                   __global const float *restrict target, gscl_visual_scales scales,
                                                   __global float *restrict moments,
                                                   __global float *restrict row_sums) {
    __local float shared[GSCL_VISUAL_SUMS * GSCL_SUM_ITEMS];
    int y = (int)get_group_id(0);
    gscl_visual_scale s = scale_of_row(scales, &y);
    rows += 4 * (size_t)s.padded_before;
    statistics += 2 * (size_t)s.before;
    rendering += s.padded_before;
    target += s.padded_before;
    moments += 3 * (size_t)s.before;
    pix sums[GSCL_VISUAL_SUMS];
    for (int j = 0; j < GSCL_VISUAL_SUMS; j++) sums[j] = (pix)(0.0f);
    FOR_VECTORS(x, s) {
        size_t at = padded_at(s, x, y), to = plain_at(s, x, y);
        for (int j = 0; j < 3; j++)
            pix_store_clipped(column_sum(rows + j * padded_plane(s), at, s.stride), moments + j * plain_plane(s) + to,
                              s.width - x);
        visual_terms t = terms_of(moments, statistics, rendering, target, s, x, y);
        /* Lanes beyond the row hold values of no meaning, of which a product with 0 may be no number. */
        pix_mask inside = pix_offsets() < (pix)((float)(s.width - x));
        pix zero = (pix)(0.0f), d = select(zero, t.d, inside), e = select(zero, t.e, inside);
        pix maps[3] = {d, fmax(e, zero), fmax(-e, zero)};
        UNROLL
        for (int j = 0; j < 3; j++) {
            pix square = maps[j] * maps[j];
            sums[2 * j] += maps[j];
            sums[2 * j + 1] = fma(square, square, sums[2 * j + 1]);
        }
        pix error = select(zero, t.y - t.x, inside), square = error * error;
        sums[GSCL_VISUAL_PEAKS] = fma(square * square, square, sums[GSCL_VISUAL_PEAKS]);
    }
    float totals[GSCL_VISUAL_SUMS];
    for (int j = 0; j < GSCL_VISUAL_SUMS; j++) totals[j] = pix_sum(sums[j]);
    group_sums(totals, GSCL_VISUAL_SUMS, shared);
    for (int j = (int)get_local_id(0); j < GSCL_VISUAL_SUMS; j += (int)get_local_size(0))
        row_sums[(int)get_group_id(0) * GSCL_VISUAL_SUMS + j] = totals[j];
}

/* The derivative of the loss by a map's value v is shares[2 j] + shares[2 j + 1] v^3, by an error shares[PEAKS] times
 * its 5th power: GSCL_VISUAL_SUMS shares of each scale.  Also writes the loss of each scale.  One work-group of each. */
__kernel GROUP_OF(SUM_ITEMS) void visual_shares(__global const float *restrict row_sums, gscl_visual_scales t,
                                                gscl_visual_scale_weights weights, float unit,
                                                __global float *restrict shares, __global float *restrict losses) {
    __local float shared[GSCL_VISUAL_SUMS * GSCL_SUM_ITEMS];
    const int k = (int)get_group_id(0);
    const gscl_visual_scale s = scale_of(t, k);
    const gscl_visual_weights w = k == 0 ? weights.scale[0] : k == 1 ? weights.scale[1] : weights.scale[2];
    /* Copied, because Mesa's compiler fails on a run-time index into a struct that was passed by value. */
    const float by_sum[GSCL_VISUAL_SUMS] = {w.weight[0], w.weight[1], w.weight[2], w.weight[3],
                                            w.weight[4], w.weight[5], w.weight[6]};
    float pixels = (float)s.width * (float)s.height, total = 0.0f;
    row_sums += rows_before(t, k) * GSCL_VISUAL_SUMS;
    shares += k * GSCL_VISUAL_SUMS;
    FOR_SHARES(i) {
        for (int j = 0; j < GSCL_VISUAL_SUMS; j++) shared[j * GSCL_SUM_ITEMS + i] = 0.0f;
        for (int y = i; y < s.height; y += GSCL_SUM_ITEMS)
            for (int j = 0; j < GSCL_VISUAL_SUMS; j++)
                shared[j * GSCL_SUM_ITEMS + i] += row_sums[y * GSCL_VISUAL_SUMS + j];
    }
    shares_sum(GSCL_VISUAL_SUMS, shared);
    if (get_local_id(0) > 0) return;
    for (int j = 0; j < GSCL_VISUAL_SUMS; j++) {
        float power = j == GSCL_VISUAL_PEAKS ? 6.0f : j % 2 ? 4.0f : 1.0f;
        float sum = shared[j * GSCL_SUM_ITEMS], weight = by_sum[j];
        float norm = exp2(log2(fmax(sum / pixels, 1e-30f)) / power);
        total = fma(weight, norm, total);
        shares[j] = unit * weight / pixels * exp2((1.0f - power) * log2(norm));
    }
    losses[k] = unit * total;
}

/* Derivatives by the rendering's mean, its E[y y] and E[x y], and the curvature under the windows: four padded planes.
 * Directly by the rendering, first and second: two plain planes. */
void make_maps(__global const float *restrict moments, __global const float *restrict statistics,
               __global const float *restrict rendering, __global const float *restrict target, gscl_visual_scale s,
               int x, int y, __global const float *restrict shares, __global float *maps,
               __global float *restrict direct) {
    visual_terms t = terms_of(moments, statistics, rendering, target, s, x, y);
    pix zero = (pix)(0.0f);
    pix by_d = fma((pix)(shares[1]), t.d * t.d * t.d, (pix)(shares[0]));
    by_d = select(zero, by_d, t.d > zero);
    pix by_xy = -2.0f * by_d * t.luminance / t.variances;
    pix by_yy = -0.5f * by_xy * t.structure;
    pix by_mean = 2.0f * by_d * t.structure * (t.mean_y - t.mean_x) - by_xy * (t.mean_x - t.structure * t.mean_y);
    pix size = fabs(t.e), cube = size * size * size;
    pix by_size = select(fma((pix)(shares[5]), cube, (pix)(shares[4])), fma((pix)(shares[3]), cube, (pix)(shares[2])),
                         t.e > zero);
    pix by_difference = by_size / (1.0f + fabs(t.x - t.mean_x));
    pix by_y = by_difference * sign(t.e) * sign(t.y - t.mean_y);
    pix error = t.y - t.x, square_error = error * error, peak = shares[GSCL_VISUAL_PEAKS] * square_error * square_error;
    size_t at = padded_at(s, x, y), plane = padded_plane(s), to = plain_at(s, x, y);
    int lanes = s.width - x;
    pix_store_clipped(by_mean - by_y, maps + at, lanes);
    pix_store_clipped(by_yy, maps + plane + at, lanes);
    pix_store_clipped(by_xy, maps + 2 * plane + at, lanes);
    pix_store_clipped(-by_xy, maps + 3 * plane + at, lanes);
    pix_store_clipped(fma(peak, error, by_y), direct + to, lanes);
    pix_store_clipped(by_difference / fmax(size, (pix)(MIN_DIFFERENCE)) + PEAK_CURVATURE * peak,
                      direct + plain_plane(s) + to, lanes);
}

/* Horizontal sums of the four maps. */
void blur_maps(__global const float *maps, gscl_visual_scale s, int x, int y, __global float *rows) {
    for (int j = 0; j < 4; j++) {
        size_t at = j * padded_plane(s) + padded_at(s, x, y);
        pix sum = (pix)(0.0f);
        for (int t = 0; t < TAPS; t++) sum = fma((pix)(window[t]), PIX_LOAD(maps + at + t - HALF_WINDOW), sum);
        pix_store_clipped(sum, rows + at, s.width - x);
    }
}

/* The maps of a row, and their horizontal sums. */
__kernel GROUP_OF(SUM_ITEMS) void visual_maps_row(__global const float *restrict moments,
                                                  __global const float *restrict statistics,
                                                  __global const float *restrict rendering,
                                                  __global const float *restrict target, gscl_visual_scales t,
                                                  __global const float *restrict shares, __global float *restrict maps,
                                                  __global float *restrict direct, __global float *restrict rows) {
    const int row = (int)get_group_id(0);
    int y = row;
    gscl_visual_scale s = scale_of_row(t, &y);
    moments += 3 * (size_t)s.before;
    statistics += 2 * (size_t)s.before;
    direct += 2 * (size_t)s.before;
    rendering += s.padded_before;
    target += s.padded_before;
    maps += 4 * (size_t)s.padded_before;
    rows += 4 * (size_t)s.padded_before;
    for (int k = 1; k < t.count && row >= rows_before(t, k); k++) shares += GSCL_VISUAL_SUMS;
    FOR_VECTORS(x, s) make_maps(moments, statistics, rendering, target, s, x, y, shares, maps, direct);
    barrier(CLK_GLOBAL_MEM_FENCE);
    FOR_VECTORS(x, s) blur_maps(maps, s, x, y, rows);
}

/* What a plane that was halved `halvings` times adds to LANES pixels of a row of its original, as the transposed operation:
 * a quarter of each value for each halving; an odd last row or column counts twice. */
pix load_enlarged(__global const float *restrict smaller, int halvings, gscl_visual_scale s, int x, int y) {
    float values[LANES], share = 1.0f;
    int width = s.width, height = s.height;
    for (int k = 0; k < halvings; k++) {
        share *= height % 2 == 1 && y >> k == height - 1 ? 0.5f : 0.25f;
        width = (width + 1) / 2;
        height = (height + 1) / 2;
    }
    __global const float *row = smaller + (size_t)(y >> halvings) * width + (x >> halvings);
    if (s.width - x > LANES + (1 << halvings)) { /* fast: no pixel is of a last column */
        if (halvings == 2) {
            UNROLL
            for (int i = 0; i < LANES; i++) values[i] = row[i / 4];
        } else {
            UNROLL
            for (int i = 0; i < LANES; i++) values[i] = row[i >> halvings];
        }
        return share * PIX_LOAD(values);
    }
    for (int i = 0; i < LANES; i++) values[i] = x + i < s.width ? row[i >> halvings] : 0.0f;
    width = s.width;
    for (int k = 0; k < halvings; k++) {
        for (int i = 0; i < LANES; i++)
            if (width % 2 == 1 && (x + i) >> k == width - 1) values[i] *= 2.0f;
        width = (width + 1) / 2;
    }
    return share * PIX_LOAD(values);
}

/* The derivative and the curvature by luminance from the terms of scale `s` and, where there is one, from the next `smaller`
 * scale: two plain planes each. */
void by_luminance_of(__global const float *restrict rows, __global const float *restrict direct,
                     __global const float *restrict rendering, __global const float *restrict target,
                     gscl_visual_scale s, int x, int y, bool has_smaller, gscl_visual_scale smaller,
                     __global float *by_luminance) {
    size_t at = padded_at(s, x, y), plane = plain_plane(s), to = 2 * (size_t)s.before + plain_at(s, x, y);
    pix sums[4], a = PIX_LOAD(rendering + s.padded_before + at), b = PIX_LOAD(target + s.padded_before + at);
    pix root = a - LUMA_OFFSET, root_slope = (1.0f / 3.0f) / (root * root);
    for (int j = 0; j < 4; j++)
        sums[j] = column_sum(rows + 4 * (size_t)s.padded_before + j * padded_plane(s), at, s.stride);
    pix slope = root_slope * (PIX_LOAD(direct + to) + sums[0] + 2.0f * a * sums[1] + b * sums[2]);
    pix curvature = root_slope * root_slope * (PIX_LOAD(direct + plane + to) + sums[3]);
    if (has_smaller) {
        __global const float *from = by_luminance + 2 * (size_t)smaller.before;
        slope += load_enlarged(from, 1, s, x, y);
        curvature += load_enlarged(from + plain_plane(smaller), 1, s, x, y);
    }
    pix_store_clipped(slope, by_luminance + to, s.width - x);
    pix_store_clipped(curvature, by_luminance + plane + to, s.width - x);
}

/* The same of all scales, the smallest first, and *loss, the sum of their losses.  `rows`: the result of visual_maps_row. */
__kernel GROUP_OF(SUM_ITEMS) void visual_by_luminance_strip(
    __global const float *restrict rows, __global const float *restrict direct,
    __global const float *restrict rendering, __global const float *restrict target, gscl_visual_scales t,
    __global float *restrict by_luminance, __global const float *restrict losses, __global float *restrict loss) {
    float sum = 0.0f;
    for (int k = t.count - 1; k >= 0; k--) {
        gscl_visual_scale s = scale_of(t, k), smaller = scale_of(t, k + 1);
        const int2 strip = rows_of_strip(t, k, (int)get_group_id(0));
        for (int y = strip.x; y < strip.y; y++) FOR_VECTORS(x, s)
        by_luminance_of(rows, direct, rendering, target, s, x, y, k + 1 < t.count, smaller, by_luminance);
        sum += losses[k];
        barrier(CLK_GLOBAL_MEM_FENCE);
    }
    if (get_global_id(0) == 0) *loss = sum;
}

/* One plane of the result of visual_by_luminance_strip, which is of this size or was halved. */
pix load_by_luminance(__global const float *restrict by_luminance, int halvings, int j, gscl_visual_scale s, int x,
                      int y) {
    if (halvings == 0) return PIX_LOAD(by_luminance + j * plain_plane(s) + plain_at(s, x, y));
    int width = s.width, height = s.height;
    for (int k = 0; k < halvings; k++) {
        width = (width + 1) / 2;
        height = (height + 1) / 2;
    }
    return load_enlarged(by_luminance + j * (size_t)width * height, halvings, s, x, y);
}

/* The derivative by the sRGB samples of the rendering, CHANNELS planes: of the visual loss, plus the samples' error. */
__kernel GROUP_OF(CHUNK_ITEMS) void visual_derivative(__global const float *restrict by_luminance, int halvings,
                                                      __global const float *restrict rendering,
                                                      __global const float *restrict target, gscl_visual_scale s,
                                                      __global float *restrict derivative) {
    int x, y;
    if (!visual_position(get_global_id(0), s, &x, &y)) return;
    size_t at = plain_at(s, x, y), plane = plain_plane(s);
    pix slope = load_by_luminance(by_luminance, halvings, 0, s, x, y);
    for (int k = 0; k < CHANNELS; k++) {
        pix a = PIX_LOAD(rendering + k * plane + at), g = a - PIX_LOAD(target + k * plane + at);
        if (k < COLOURS) g = fma(luma_share(k) * slope, linear_slope(a), g);
        pix_store_clipped(g, derivative + k * plane + at, s.width - x);
    }
}

/* The quadratic model, behind CHANNELS planes of the target: the weight of the squared error of luma, and its target.
 * This luma is the mean of sRGB samples by their shares. */
__kernel GROUP_OF(CHUNK_ITEMS) void visual_model(__global const float *restrict by_luminance, int halvings,
                                                 __global const float *restrict rendering, gscl_visual_scale s,
                                                 float curvature_share, __global float *restrict model) {
    int x, y;
    if (!visual_position(get_global_id(0), s, &x, &y)) return;
    size_t at = plain_at(s, x, y), plane = plain_plane(s);
    pix luma = (pix)(0.0f), slope = (pix)(0.0f); /* of luminance by luma */
    UNROLL
    for (int k = 0; k < COLOURS; k++) {
        pix a = PIX_LOAD(rendering + k * plane + at);
        luma = fma((pix)(luma_share(k)), a, luma);
        slope = fma((pix)(luma_share(k)), linear_slope(a), slope);
    }
    pix weight = curvature_share * slope * slope * load_by_luminance(by_luminance, halvings, 1, s, x, y);
    weight = fmax(weight, (pix)(MIN_LUMA_WEIGHT));
    pix by_luma = slope * load_by_luminance(by_luminance, halvings, 0, s, x, y);
    pix_store_clipped(weight, model + CHANNELS * plane + at, s.width - x);
    pix_store_clipped(luma - by_luma / weight, model + (CHANNELS + 1) * plane + at, s.width - x);
}
