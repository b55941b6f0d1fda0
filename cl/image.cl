/* Image planes for the fit: pyramid levels and per-pixel error. */

/* Halves a plane by averaging 2x2 pixels; an odd last row or column is averaged with itself. */
__kernel GROUP_OF(GSCL_IMAGE_GROUP) void halve(__global const float *restrict from, ulong from_at, int from_width,
                                               int from_height, __global float *restrict to, ulong to_at, int width,
                                               int height) {
    int i = (int)get_global_id(0);
    if (i >= width * height) return;
    from += from_at;
    to += to_at;
    int x = 2 * (i % width), y = 2 * (i / width);
    int x1 = min(x + 1, from_width - 1), y1 = min(y + 1, from_height - 1);
    __global const float *row0 = from + (size_t)y * from_width, *row1 = from + (size_t)y1 * from_width;
    to[i] = 0.25f * ((row0[x] + row0[x1]) + (row1[x] + row1[x1]));
}

/* The residual of planes against those of half the size, interpolated with their slopes: squared difference per sample,
 * for each pixel of the smaller planes. */
__kernel GROUP_OF(GSCL_IMAGE_GROUP) void level_residual(__global const float *restrict planes,
                                                        __global const float *restrict half_size, int channels,
                                                        int width, int height, __global float *restrict map) {
    int half_width = (width + 1) / 2, half_height = (height + 1) / 2, at = (int)get_global_id(0);
    if (at >= half_width * half_height) return;
    int x = at % half_width, y = at / half_width;
    int left = max(x - 1, 0), right = min(x + 1, half_width - 1);
    int above = max(y - 1, 0), below = min(y + 1, half_height - 1);
    float sum = 0.0f;
    for (int k = 0; k < channels; k++, planes += (size_t)width * height, half_size += half_width * half_height) {
        float slope_x =
            (half_size[y * half_width + right] - half_size[y * half_width + left]) / (float)max(right - left, 1);
        float slope_y =
            (half_size[below * half_width + x] - half_size[above * half_width + x]) / (float)max(below - above, 1);
        for (int i = 0; i < 4; i++) {
            int dx = i & 1, dy = i >> 1;
            float guess = half_size[at] + (dx ? 0.25f : -0.25f) * slope_x + (dy ? 0.25f : -0.25f) * slope_y;
            float e = planes[(size_t)min(2 * y + dy, height - 1) * width + min(2 * x + dx, width - 1)] - guess;
            sum = fma(e, e, sum);
        }
    }
    map[at] = sum / (float)(4 * channels);
}

/* The luma of pixel i of planes: of the first three channels, or of the only colour. */
float luma_of(__global const float *restrict planes, int channels, int count, int i) {
    const float shares[3] = {GSCL_LUMA_SHARES};
    if (channels < 3) return planes[i];
    float luma = 0.0f;
    for (int k = 0; k < 3; k++) luma = fma(shares[k], planes[(size_t)k * count + i], luma);
    return luma;
}

/* Squared error of pixel i, added over channels.  `weighted`: GSCL_WEIGHTED_..., whose planes lie behind the target's. */
float error_of_pixel(__global const float *restrict rendering, __global const float *restrict target, int channels,
                     int weighted, int count, int i) {
    __global const float *weights = target + (size_t)channels * count;
    float sum = 0.0f;
    for (int k = 0; k < channels; k++) {
        float e = rendering[(size_t)k * count + i] - target[(size_t)k * count + i];
        sum = fma(e, e, sum);
    }
    if (weighted == GSCL_WEIGHTED_PIXELS) sum *= weights[i];
    if (weighted == GSCL_WEIGHTED_LUMA) {
        float e = luma_of(rendering, channels, count, i) - weights[(size_t)count + i];
        sum = fma(weights[i] * e, e, sum);
    }
    return sum;
}

/* Squared error of each pixel. */
__kernel GROUP_OF(GSCL_IMAGE_GROUP) void squared_error(__global const float *restrict rendering,
                                                       __global const float *restrict target, int channels,
                                                       int weighted, int count, __global float *restrict error) {
    int i = (int)get_global_id(0);
    if (i < count) error[i] = error_of_pixel(rendering, target, channels, weighted, count, i);
}

/* Adds `share` times a plane that is 2^shift times smaller to the plane at to[to_at]. */
__kernel GROUP_OF(GSCL_IMAGE_GROUP) void add_enlarged(__global const float *restrict from, gscl_enlargement t,
                                                      __global float *restrict to, ulong to_at) {
    int i = (int)get_global_id(0);
    if (i >= t.width * t.height) return;
    int x = min((i % t.width) >> t.shift, t.from_width - 1), y = min((i / t.width) >> t.shift, t.from_height - 1);
    to[to_at + i] = fma(t.share, from[(size_t)y * t.from_width + x], to[to_at + i]);
}

/* Raises the contrast of `channels` planes around local means.  Gains and means are planes of half the size
 * (ssim_contrast_gains). */
__kernel GROUP_OF(GSCL_IMAGE_GROUP) void raise_contrast(__global const float *restrict from,
                                                        __global const float *restrict gains, int channels, int width,
                                                        int height, __global float *restrict to) {
    int i = (int)get_global_id(0);
    if (i >= width * height) return;
    int half_width = (width + 1) / 2, half_height = (height + 1) / 2;
    size_t at = (size_t)(i / width / 2) * half_width + i % width / 2, half_plane = (size_t)half_width * half_height;
    for (int k = 0; k < channels; k++) {
        float value = from[(size_t)k * width * height + i];
        float gain = gains[k * half_plane + at], mean = gains[(channels + k) * half_plane + at];
        to[(size_t)k * width * height + i] = fma(gain, value - mean, value);
    }
}
