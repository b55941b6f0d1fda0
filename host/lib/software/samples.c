#include "software/samples.h"

#include "software/float_bits.h"

static void clamp_row(float *restrict v, int count) {
    for (int i = 0; i < count; i++)
        v[i] = gscl_lesser_positive(gscl_positive_part(v[i]), 1.0f);
}

/* Clamps a colour to alpha and, unless it stays premultiplied, divides it by alpha; 0 where alpha is 0. */
static void divide_row(float *restrict v, const float *restrict alpha, bool premultiplied, int count) {
    const float smallest = 1e-30f;
    for (int i = 0; i < count; i++)
        v[i] = gscl_lesser_positive(v[i], alpha[i]);
    for (int i = 0; i < count && !premultiplied; i++)
        v[i] /= gscl_larger_positive(alpha[i], smallest);
}

static const float half = 0.5f; /* positive numbers are rounded by truncation */

/* Stores one channel, its samples `stride` apart; `v` is NULL for a channel of ones. */
static void store_u8(const float *v, uint8_t *to, size_t stride, int count) {
    for (int i = 0; i < count; i++)
        to[(size_t)i * stride] = v ? (uint8_t)(int)(v[i] * 255.0f + half) : 255;
}
static void store_u16(const float *v, uint16_t *to, size_t stride, int count) {
    for (int i = 0; i < count; i++)
        to[(size_t)i * stride] = v ? (uint16_t)(int)(v[i] * 65535.0f + half) : 65535;
}
static void store_f32(const float *v, float *to, size_t stride, int count) {
    for (int i = 0; i < count; i++)
        to[(size_t)i * stride] = v ? v[i] : 1.0f;
}

static void store_channel(const gscl_image *image, const float *v, uint32_t channel, int count, void *pixels) {
    if (image->sample == GSCL_SAMPLE_U8)
        store_u8(v, (uint8_t *)pixels + channel, image->channels, count);
    else if (image->sample == GSCL_SAMPLE_U16)
        store_u16(v, (uint16_t *)pixels + channel, image->channels, count);
    else
        store_f32(v, (float *)pixels + channel, image->channels, count);
}

void gscl_store_samples(const gscl_image *image, float *const values[4], int colours, bool has_alpha, int count,
                        void *pixels) {
    const uint32_t stored = image->channels >= 3 ? 3 : 1;
    const float *alpha = has_alpha ? values[colours] : NULL;
    for (int k = 0; k < colours + has_alpha; k++)
        clamp_row(values[k], count);
    for (int k = 0; k < colours && has_alpha; k++)
        divide_row(values[k], alpha, image->premultiplied, count);
    for (uint32_t k = 0; k < image->channels; k++)
        store_channel(image, k == stored ? alpha : values[colours == 3 ? k : 0], k, count, pixels);
}
