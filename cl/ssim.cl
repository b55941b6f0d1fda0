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
#define C1 1e-4f       /* (0.01 L)^2, L = 1 */
#define C2 9e-4f       /* (0.03 L)^2 */
#define SMOOTHING 0.8f /* exponent on weights; below 1 measured better, by MS-SSIM */

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

/* Vertical sums, SSIM of each window, and its derivatives by E[x], E[xx] and E[xy] (three padded images, zero
 * where there is no window). */
__kernel void ssim_windows(__global const float *restrict moments, int width, int height, int channels, int stride,
                           ulong image, __global float *restrict slopes) {
    int x, y, k;
    if (!ssim_place(width, height, channels, &x, &y, &k)) return;
    pix m[5];
    for (int j = 0; j < 5; j++) {
        m[j] = (pix)(0.0f);
        for (int t = 0; t < TAPS; t++)
            m[j] = fma((pix)(window[t]), PIX_LOAD(moments + j * image + PADDED(x, y + t, k)), m[j]);
    }
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
 * SSIM's contrast-structure factor is 1 - V / (B + C2), with the error's variance V in the window and the sum B of both
 * images' variances there.  With the picture's variance taken to be small, a window's squared error counts as
 * 1 / (variance + C2). */

/* C2 / (variance + C2) of each window of the image that `moments` (ssim_rows of an image with itself) are of. */
__kernel void ssim_smoothness(__global const float *restrict moments, int width, int height, int channels, int stride,
                              ulong image, __global float *restrict smoothness) {
    int x, y, k;
    if (!ssim_place(width, height, channels, &x, &y, &k)) return;
    pix mean = (pix)(0.0f), square = (pix)(0.0f);
    for (int t = 0; t < TAPS; t++) {
        mean = fma((pix)(window[t]), PIX_LOAD(moments + PADDED(x, y + t, k)), mean);
        square = fma((pix)(window[t]), PIX_LOAD(moments + 2 * image + PADDED(x, y + t, k)), square);
    }
    pix there = y + TAPS <= height ? pix_inside(width - TAPS + 1 - x) : (pix)(0.0f);
    pix_store_clipped(there * C2 / (fmax(square - mean * mean, (pix)(0.0f)) + C2), smoothness + PADDED(x, y, k),
                      width - x);
}

/* What each pixel's squared error counts: the mean over the windows that see it (`sums`: ssim_columns of the
 * smoothness), added over channels.  Images without windows count the same everywhere. */
__kernel void ssim_weights(__global const float *restrict sums, int width, int height, int channels, int stride,
                           ulong image, __global float *restrict weights) {
    int x, y, unused;
    if (!ssim_place(width, height, 1, &x, &y, &unused)) return;
    pix sum = (pix)(0.0f), seen_x = (pix)(0.0f);
    float seen_y = 0.0f;
    for (int t = 0; t < TAPS; t++) {
        for (int k = 0; k < channels; k++) sum = fma((pix)(window[t]), PIX_LOAD(sums + PADDED(x, y, k) - t), sum);
        pix from = pix_offsets() + (float)(x - t);
        seen_x += select((pix)(0.0f), (pix)(window[t]), from >= (pix)(0.0f) && from <= (pix)((float)(width - TAPS)));
        if (y - t >= 0 && y - t <= height - TAPS) seen_y += window[t];
    }
    bool windows = width >= TAPS && height >= TAPS;
    pix weight = windows ? pow(sum / (seen_x * seen_y), (pix)(SMOOTHING)) : (pix)(1.0f);
    pix_store_clipped(weight, weights + (size_t)y * width + x, width - x);
}
