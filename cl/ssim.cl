/* Loss (1 - w) L1 + w (1 - SSIM) / 2 over an image, and its derivative by the picture (the paper's P4).
 *
 * SSIM after Wang et al. 2004: 11x11 Gaussian window of sigma 1.5, only windows that lie inside the image.
 * With the window's moments m = E[x], E[y], E[xx], E[yy], E[xy], the derivative by pixel x_i is the sum over
 * its windows of weight_i * (dS/dE[x] + 2 x_i dS/dE[xx] + y_i dS/dE[xy]): three maps, blurred back.
 *
 * All planes here have rows of `stride` floats, `MARGIN` zeros left and right and MARGIN rows of zeros above and
 * below, so that no work-item looks at a border.  One work-item: LANES pixels of a row of one channel. */
#define TAPS 11
#define MARGIN GSCL_SSIM_MARGIN
#define C1 1e-4f /* (0.01 L)^2, L = 1 */
#define C2 9e-4f /* (0.03 L)^2 */

__constant float window[TAPS] = {0.00102838f, 0.00759876f, 0.03600077f, 0.10936069f, 0.21300553f, 0.26601172f,
                                 0.21300553f, 0.10936069f, 0.03600077f, 0.00759876f, 0.00102838f};

/* Where a work-item stands: first pixel, row and channel; false beyond the end. */
inline bool ssim_place(int width, int height, int channels, int *x, int *y, int *k) {
    int chunks = (width + LANES - 1) / LANES, i = (int)get_global_id(0);
    *x = i % chunks * LANES;
    *y = i / chunks % height;
    *k = i / chunks / height;
    return *k < channels;
}

#define PADDED(x, y, k) (((size_t)(k) * (height + 2 * MARGIN) + (y) + MARGIN) * stride + (x) + MARGIN)

/* Horizontal sums of x, y, xx, yy, xy: windows begin at their pixel.  `moments`: five padded images. */
__kernel void ssim_rows(__global const float *restrict picture, __global const float *restrict target, int width,
                        int height, int channels, int stride, ulong image, __global float *restrict moments) {
    int x, y, k;
    if (!ssim_place(width, height, channels, &x, &y, &k)) return;
    pix m[5];
    for (int j = 0; j < 5; j++) m[j] = (pix)(0.0f);
    size_t from = ((size_t)k * height + y) * width + x;
    for (int t = 0; t < TAPS; t++) {
        pix a = pix_load_clipped(picture + from + t, width - x - t),
            b = pix_load_clipped(target + from + t, width - x - t);
        pix wa = window[t] * a, wb = window[t] * b;
        m[0] += wa;
        m[1] += wb;
        m[2] = fma(wa, a, m[2]);
        m[3] = fma(wb, b, m[3]);
        m[4] = fma(wa, b, m[4]);
    }
    for (int j = 0; j < 5; j++) pix_store_clipped(m[j], moments + j * image + PADDED(x, y, k), width - x);
}

/* Vertical sums of what ssim_rows left: E[x], E[y], E[xx], E[yy], E[xy] of the windows that begin here. */
inline void window_moments(pix *restrict m, __global const float *restrict moments, int x, int y, int k, int height,
                           int stride, ulong image) {
    for (int j = 0; j < 5; j++) {
        m[j] = (pix)(0.0f);
        for (int t = 0; t < TAPS; t++)
            m[j] = fma((pix)(window[t]), PIX_LOAD(moments + j * image + PADDED(x, y + t, k)), m[j]);
    }
}

/* SSIM of each window, and its derivatives by E[x], E[xx] and E[xy] (three padded images, zero
 * where there is no window). */
__kernel void ssim_windows(__global const float *restrict moments, int width, int height, int channels, int stride,
                           ulong image, __global float *restrict slopes) {
    int x, y, k;
    if (!ssim_place(width, height, channels, &x, &y, &k)) return;
    pix m[5];
    window_moments(m, moments, x, y, k, height, stride, image);
    pix a1 = 2.0f * m[0] * m[1] + C1, b1 = m[0] * m[0] + m[1] * m[1] + C1;
    pix a2 = 2.0f * (m[4] - m[0] * m[1]) + C2;
    pix b2 = fmax(m[2] - m[0] * m[0], (pix)(0.0f)) + fmax(m[3] - m[1] * m[1], (pix)(0.0f)) + C2;
    pix mean = a1 / b1, structure = a2 / b2;
    pix by_x = 2.0f * (structure * (m[1] - m[0] * mean) / b1 + mean * (m[0] * structure - m[1]) / b2);
    pix by_xx = -mean * structure / b2, by_xy = 2.0f * mean / b2;
    pix there = y + TAPS <= height ? pix_inside(width - TAPS + 1 - x) : (pix)(0.0f);
    pix_store_clipped(by_x * there, slopes + PADDED(x, y, k), width - x);
    pix_store_clipped(by_xx * there, slopes + image + PADDED(x, y, k), width - x);
    pix_store_clipped(by_xy * there, slopes + 2 * image + PADDED(x, y, k), width - x);
}

/* Adds the windows above: the vertical blur, turned round. */
__kernel void ssim_columns(__global const float *restrict slopes, int width, int height, int channels, int stride,
                           ulong image, __global float *restrict sums) {
    int x, y, k;
    if (!ssim_place(width, height, channels, &x, &y, &k)) return;
    for (int j = 0; j < 3; j++) {
        pix sum = (pix)(0.0f);
        for (int t = 0; t < TAPS; t++)
            sum = fma((pix)(window[t]), PIX_LOAD(slopes + j * image + PADDED(x, y - t, k)), sum);
        pix_store_clipped(sum, sums + j * image + PADDED(x, y, k), width - x);
    }
}

/* Adds the windows to the left, and puts the loss's derivative together.  `share` is w / 2 times samples by windows,
 * so that both terms are means. */
__kernel void ssim_slope(__global const float *restrict sums, __global const float *restrict picture,
                         __global const float *restrict target, int width, int height, int channels, int stride,
                         ulong image, float l1_share, float share, __global float *restrict derivative) {
    int x, y, k;
    if (!ssim_place(width, height, channels, &x, &y, &k)) return;
    pix s[3];
    for (int j = 0; j < 3; j++) {
        s[j] = (pix)(0.0f);
        for (int t = 0; t < TAPS; t++)
            s[j] = fma((pix)(window[t]), PIX_LOAD(sums + j * image + PADDED(x, y, k) - t), s[j]);
    }
    size_t at = ((size_t)k * height + y) * width + x;
    pix a = pix_load_clipped(picture + at, width - x), b = pix_load_clipped(target + at, width - x);
    pix by_ssim = s[0] + 2.0f * a * s[1] + b * s[2];
    pix_store_clipped(l1_share * sign(a - b) - share * by_ssim, derivative + at, width - x);
}

/* ---- Squared error in place of MS-SSIM --------------------------------------------------------------------------
 *
 * SSIM's contrast-structure factor of a window, S = 2 cov / (A + B) with the variances A of the image and B of the
 * picture (C2 left out), has the derivative 2 (a / S - b) S / (A + B) by the picture's b, means taken off: that of
 * squared error against an image of 1 / S times the contrast, weighed by 1 / (A + B).  Where the picture is not
 * yet known, B counts as 0 and S as 1. */

#define MAPS 3
#define MAP_WEIGHT 0
#define MAP_GAIN 1 /* of contrast: 1 / S - 1 */
#define MAP_MEAN 2 /* of the image */
#define MOST_GAIN 0.5f
#define SMOOTHING 0.8f /* exponent on weights before the picture is known; below 1 measured better */

/* Judges each window: writes MAPS padded images.  `moments`: ssim_rows of the picture and the image; not `known`: of
 * the image with itself. */
__kernel void ssim_judge(__global const float *restrict moments, int width, int height, int channels, int stride,
                         ulong image, int known, __global float *restrict maps) {
    int x, y, k;
    if (!ssim_place(width, height, channels, &x, &y, &k)) return;
    pix m[5];
    window_moments(m, moments, x, y, k, height, stride, image);
    pix projected = fmax(m[2] - m[0] * m[0], (pix)(0.0f)) * (float)known;
    pix variances = fmax(m[3] - m[1] * m[1], (pix)(0.0f)) + projected + C2;
    pix similarity = fma((pix)(2.0f), m[4] - m[0] * m[1], (pix)(C2)) / variances;
    pix gain = fmin(1.0f / fmax(similarity, (pix)(0.1f)) - 1.0f, (pix)(MOST_GAIN));
    pix there = y + TAPS <= height ? pix_inside(width - TAPS + 1 - x) : (pix)(0.0f);
    pix_store_clipped(there * C2 / variances, maps + MAP_WEIGHT * image + PADDED(x, y, k), width - x);
    pix_store_clipped(there * gain * (float)known, maps + MAP_GAIN * image + PADDED(x, y, k), width - x);
    pix_store_clipped(there * m[1], maps + MAP_MEAN * image + PADDED(x, y, k), width - x);
}

/* Adds the windows to the left in a map that ssim_columns has blurred. */
inline pix map_sum(__global const float *restrict sums, int x, int y, int k, int height, int stride) {
    pix sum = (pix)(0.0f);
    for (int t = 0; t < TAPS; t++) sum = fma((pix)(window[t]), PIX_LOAD(sums + PADDED(x, y, k) - t), sum);
    return sum;
}

/* How much of a whole window's weight sees these pixels. */
inline pix window_cover(int x, int y, int width, int height) {
    pix seen_x = (pix)(0.0f);
    float seen_y = 0.0f;
    for (int t = 0; t < TAPS; t++) {
        pix from = pix_offsets() + (float)(x - t);
        seen_x += select((pix)(0.0f), (pix)(window[t]), from >= (pix)(0.0f) && from <= (pix)((float)(width - TAPS)));
        if (y - t >= 0 && y - t <= height - TAPS) seen_y += window[t];
    }
    return seen_x * seen_y;
}

/* What each pixel's squared error counts: the mean over the windows that see it, added over channels.  Images without
 * windows count the same everywhere. */
__kernel void ssim_weights(__global const float *restrict sums, int width, int height, int channels, int stride,
                           ulong image, int known, __global float *restrict weights) {
    int x, y, unused;
    if (!ssim_place(width, height, 1, &x, &y, &unused)) return;
    pix sum = (pix)(0.0f);
    for (int k = 0; k < channels; k++) sum += map_sum(sums + MAP_WEIGHT * image, x, y, k, height, stride);
    pix weight = (pix)(1.0f);
    if (width >= TAPS && height >= TAPS) weight = sum / window_cover(x, y, width, height);
    if (!known) weight = pow(weight, (pix)(SMOOTHING));
    pix_store_clipped(weight, weights + (size_t)y * width + x, width - x);
}

/* The gain and the mean at each pixel: `channels` planes of gains, then as many of means. */
__kernel void ssim_gains(__global const float *restrict sums, int width, int height, int channels, int stride,
                         ulong image, __global float *restrict gains) {
    int x, y, k;
    if (!ssim_place(width, height, channels, &x, &y, &k)) return;
    pix cover = window_cover(x, y, width, height);
    size_t at = ((size_t)k * height + y) * width + x, plane = (size_t)width * height;
    pix gain = map_sum(sums + MAP_GAIN * image, x, y, k, height, stride) / cover;
    pix mean = map_sum(sums + MAP_MEAN * image, x, y, k, height, stride) / cover;
    pix_store_clipped(gain, gains + at, width - x);
    pix_store_clipped(mean, gains + channels * plane + at, width - x);
}
