/* Structural similarity (SSIM) of a rendering and a target: a term of the loss with its derivative, and weights for
 * squared errors.
 *
 * The loss is (1 - w) L1 + w (1 - SSIM) / 2 over an image (the paper's P4).  SSIM follows Wang et al. 2004: an 11x11
 * Gaussian window of sigma 1.5, only windows that lie inside the image.  With the window's moments
 * m = E[x], E[y], E[xx], E[yy], E[xy] of the rendering x and the target y, the derivative by pixel x_i is the sum over
 * its windows of weight_i * (dS/dE[x] + 2 x_i dS/dE[xx] + y_i dS/dE[xy]): three maps that are blurred again.
 *
 * Padded images here have planes with rows of `stride` floats, MARGIN zeros left and right of each row and MARGIN rows
 * of zeros above and below, so that no work-item tests for a border.  A window is stored at its first pixel.  One
 * work-item takes LANES pixels of a row of one channel. */
#define TAPS GSCL_SSIM_WINDOW
#define MARGIN GSCL_SSIM_MARGIN
#define C1 1e-4f /* (0.01 L)^2, L = 1 */
#define C2 9e-4f /* (0.03 L)^2 */

__constant float window[TAPS] = {0.00102838f, 0.00759876f, 0.03600077f, 0.10936069f, 0.21300553f, 0.26601172f,
                                 0.21300553f, 0.10936069f, 0.03600077f, 0.00759876f, 0.00102838f};

/* First pixel, row and channel of a work-item; false beyond the end. */
bool ssim_position(size_t item, gscl_ssim_shape s, int channels, int *x, int *y, int *k) {
    int chunks = (s.width + LANES - 1) / LANES, i = (int)item;
    *x = i % chunks * LANES;
    *y = i / chunks % s.height;
    *k = i / chunks / s.height;
    return *k < channels;
}

/* Floats of a padded image, and the index of a pixel in it. */
size_t padded_size(gscl_ssim_shape s) { return (size_t)s.stride * (s.height + 2 * MARGIN) * s.channels; }
size_t padded_index(gscl_ssim_shape s, int x, int y, int k) {
    return ((size_t)k * (s.height + 2 * MARGIN) + y + MARGIN) * s.stride + x + MARGIN;
}
/* Index of a pixel in an image without padding. */
size_t plain_index(gscl_ssim_shape s, int x, int y, int k) { return ((size_t)k * s.height + y) * s.width + x; }

/* 1 in the lanes where a window begins that lies inside the image, else 0. */
pix window_mask(gscl_ssim_shape s, int x, int y) {
    return y + TAPS <= s.height ? pix_inside(s.width - TAPS + 1 - x) : (pix)(0.0f);
}

/* Horizontal sums of x, y, xx, yy, xy.  `moments`: five padded images. */
__kernel GROUP_OF(CHUNK_ITEMS) void ssim_blur_rows(__global const float *restrict rendering,
                                                   __global const float *restrict target, gscl_ssim_shape shape,
                                                   __global float *restrict moments) {
    int x, y, k;
    if (!ssim_position(get_global_id(0), shape, shape.channels, &x, &y, &k)) return;
    pix m[5];
    for (int j = 0; j < 5; j++) m[j] = (pix)(0.0f);
    size_t from = plain_index(shape, x, y, k), to = padded_index(shape, x, y, k), image = padded_size(shape);
    int lanes = shape.width - x;
    for (int t = 0; t < TAPS; t++) {
        pix a = pix_load_clipped(rendering + from + t, lanes - t), b = pix_load_clipped(target + from + t, lanes - t);
        pix wa = window[t] * a, wb = window[t] * b;
        m[0] += wa;
        m[1] += wb;
        m[2] = fma(wa, a, m[2]);
        m[3] = fma(wb, b, m[3]);
        m[4] = fma(wa, b, m[4]);
    }
    for (int j = 0; j < 5; j++) pix_store_clipped(m[j], moments + j * image + to, lanes);
}

/* Vertical sums of the result of ssim_blur_rows: E[x], E[y], E[xx], E[yy], E[xy] of the windows. */
void window_moments(pix *restrict m, __global const float *restrict moments, gscl_ssim_shape shape, int x, int y,
                    int k) {
    size_t at = padded_index(shape, x, y, k), image = padded_size(shape);
    for (int j = 0; j < 5; j++) {
        m[j] = (pix)(0.0f);
        for (int t = 0; t < TAPS; t++)
            m[j] = fma((pix)(window[t]), PIX_LOAD(moments + j * image + at + (size_t)t * shape.stride), m[j]);
    }
}

/* Derivatives of each window's SSIM by E[x], E[xx] and E[xy]: three padded images, zero where there is no window. */
__kernel GROUP_OF(CHUNK_ITEMS) void ssim_window_derivatives(__global const float *restrict moments,
                                                            gscl_ssim_shape shape,
                                                            __global float *restrict derivatives) {
    int x, y, k;
    if (!ssim_position(get_global_id(0), shape, shape.channels, &x, &y, &k)) return;
    pix m[5];
    window_moments(m, moments, shape, x, y, k);
    pix a1 = 2.0f * m[0] * m[1] + C1, b1 = m[0] * m[0] + m[1] * m[1] + C1;
    pix a2 = 2.0f * (m[4] - m[0] * m[1]) + C2;
    pix b2 = fmax(m[2] - m[0] * m[0], (pix)(0.0f)) + fmax(m[3] - m[1] * m[1], (pix)(0.0f)) + C2;
    pix mean = a1 / b1, structure = a2 / b2;
    pix by_x = 2.0f * (structure * (m[1] - m[0] * mean) / b1 + mean * (m[0] * structure - m[1]) / b2);
    pix by_xx = -mean * structure / b2, by_xy = 2.0f * mean / b2;
    pix mask = window_mask(shape, x, y);
    size_t at = padded_index(shape, x, y, k), image = padded_size(shape);
    int lanes = shape.width - x;
    pix_store_clipped(by_x * mask, derivatives + at, lanes);
    pix_store_clipped(by_xx * mask, derivatives + image + at, lanes);
    pix_store_clipped(by_xy * mask, derivatives + 2 * image + at, lanes);
}

/* Transposed vertical blur of three maps: each pixel's sum over the windows that begin above it. */
__kernel GROUP_OF(CHUNK_ITEMS) void ssim_blur_columns(__global const float *restrict maps, gscl_ssim_shape shape,
                                                      __global float *restrict sums) {
    int x, y, k;
    if (!ssim_position(get_global_id(0), shape, shape.channels, &x, &y, &k)) return;
    size_t at = padded_index(shape, x, y, k), image = padded_size(shape);
    for (int j = 0; j < 3; j++) {
        pix sum = (pix)(0.0f);
        for (int t = 0; t < TAPS; t++)
            sum = fma((pix)(window[t]), PIX_LOAD(maps + j * image + at - (size_t)t * shape.stride), sum);
        pix_store_clipped(sum, sums + j * image + at, shape.width - x);
    }
}

/* Transposed horizontal blur: a pixel's sum over the windows that begin left of it, of a map after
 * ssim_blur_columns. */
pix map_sum(__global const float *restrict sums, size_t at) {
    pix sum = (pix)(0.0f);
    for (int t = 0; t < TAPS; t++) sum = fma((pix)(window[t]), PIX_LOAD(sums + at - t), sum);
    return sum;
}

/* Finishes the blur and writes the derivative of the loss by the rendering, times the number of samples.
 * `ssim_share` is w / 2 times samples by windows, so that both terms are means; `l1_share` is 1 - w. */
__kernel GROUP_OF(CHUNK_ITEMS) void ssim_derivative(__global const float *restrict sums,
                                                    __global const float *restrict rendering,
                                                    __global const float *restrict target, gscl_ssim_shape shape,
                                                    float l1_share, float ssim_share,
                                                    __global float *restrict derivative) {
    int x, y, k;
    if (!ssim_position(get_global_id(0), shape, shape.channels, &x, &y, &k)) return;
    size_t padded = padded_index(shape, x, y, k), image = padded_size(shape);
    pix s[3];
    for (int j = 0; j < 3; j++) s[j] = map_sum(sums + j * image, padded);
    size_t at = plain_index(shape, x, y, k);
    int lanes = shape.width - x;
    pix a = pix_load_clipped(rendering + at, lanes), b = pix_load_clipped(target + at, lanes);
    pix by_ssim = s[0] + 2.0f * a * s[1] + b * s[2];
    pix_store_clipped(l1_share * sign(a - b) - ssim_share * by_ssim, derivative + at, lanes);
}

/* ---- Squared error in place of MS-SSIM --------------------------------------------------------------------------
 *
 * SSIM's contrast-structure factor of a window, S = 2 cov / (A + B) with the variances A of the target and B of the
 * rendering (C2 left out), has the derivative 2 (a / S - b) S / (A + B) by the rendering's b, where a and b are without
 * their means.  This is the derivative of squared error against a target of 1 / S times the contrast, weighted by
 * 1 / (A + B).  Without a rendering, B is taken as 0 and S as 1. */

#define MAP_WEIGHT 0
#define MAP_CONTRAST_GAIN 1 /* 1 / S - 1 */
#define MAP_MEAN 2          /* of the target */

/* Evaluates each window: writes three padded images, MAP_...  `moments`: ssim_blur_rows of the rendering and the
 * target; without a rendering, of the target with itself. */
__kernel GROUP_OF(CHUNK_ITEMS) void ssim_evaluate_windows(__global const float *restrict moments, gscl_ssim_shape shape,
                                                          int has_rendering, __global float *restrict maps) {
    int x, y, k;
    if (!ssim_position(get_global_id(0), shape, shape.channels, &x, &y, &k)) return;
    pix m[5];
    window_moments(m, moments, shape, x, y, k);
    pix rendering_variance = fmax(m[2] - m[0] * m[0], (pix)(0.0f)) * (float)has_rendering;
    pix variances = fmax(m[3] - m[1] * m[1], (pix)(0.0f)) + rendering_variance + C2;
    pix similarity = fma((pix)(2.0f), m[4] - m[0] * m[1], (pix)(C2)) / variances;
    pix gain =
        fmin(1.0f / fmax(similarity, (pix)(GSCL_SSIM_MIN_SIMILARITY)) - 1.0f, (pix)(GSCL_SSIM_MAX_CONTRAST_GAIN));
    pix mask = window_mask(shape, x, y);
    size_t at = padded_index(shape, x, y, k), image = padded_size(shape);
    int lanes = shape.width - x;
    pix_store_clipped(mask * C2 / variances, maps + MAP_WEIGHT * image + at, lanes);
    pix_store_clipped(mask * gain * (float)has_rendering, maps + MAP_CONTRAST_GAIN * image + at, lanes);
    pix_store_clipped(mask * m[1], maps + MAP_MEAN * image + at, lanes);
}

/* The sum of the window weights with which windows inside the image cover these pixels; 1 away from borders. */
pix window_cover(gscl_ssim_shape s, int x, int y) {
    pix cover_x = (pix)(0.0f);
    float cover_y = 0.0f;
    for (int t = 0; t < TAPS; t++) {
        pix from = pix_offsets() + (float)(x - t);
        cover_x += select((pix)(0.0f), (pix)(window[t]), from >= (pix)(0.0f) && from <= (pix)((float)(s.width - TAPS)));
        if (y - t >= 0 && y - t <= s.height - TAPS) cover_y += window[t];
    }
    return cover_x * cover_y;
}

/* The weight of each pixel's squared error: the mean over the windows that cover it, added over channels.  Images
 * without windows have the same weight everywhere. */
__kernel GROUP_OF(CHUNK_ITEMS) void ssim_weights(__global const float *restrict sums, gscl_ssim_shape shape,
                                                 int has_rendering, __global float *restrict weights) {
    int x, y, unused;
    if (!ssim_position(get_global_id(0), shape, 1, &x, &y, &unused)) return;
    __global const float *map = sums + MAP_WEIGHT * padded_size(shape);
    pix sum = (pix)(0.0f);
    for (int k = 0; k < shape.channels; k++) sum += map_sum(map, padded_index(shape, x, y, k));
    pix weight = (pix)(1.0f);
    if (shape.width >= TAPS && shape.height >= TAPS) weight = sum / window_cover(shape, x, y);
    if (!has_rendering) weight = pow(weight, (pix)(GSCL_SSIM_WEIGHT_EXPONENT));
    pix_store_clipped(weight, weights + plain_index(shape, x, y, 0), shape.width - x);
}

/* The contrast gain and the mean at each pixel: `channels` planes of gains, then as many of means. */
__kernel GROUP_OF(CHUNK_ITEMS) void ssim_contrast_gains(__global const float *restrict sums, gscl_ssim_shape shape,
                                                        __global float *restrict gains) {
    int x, y, k;
    if (!ssim_position(get_global_id(0), shape, shape.channels, &x, &y, &k)) return;
    pix cover = window_cover(shape, x, y);
    size_t padded = padded_index(shape, x, y, k), image = padded_size(shape);
    size_t at = plain_index(shape, x, y, k), plane = (size_t)shape.width * shape.height;
    pix gain = map_sum(sums + MAP_CONTRAST_GAIN * image, padded) / cover;
    pix mean = map_sum(sums + MAP_MEAN * image, padded) / cover;
    pix_store_clipped(gain, gains + at, shape.width - x);
    pix_store_clipped(mean, gains + shape.channels * plane + at, shape.width - x);
}
