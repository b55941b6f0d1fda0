#include "software/samples.h"

#include <string.h>

#include "image/image.h"
#include "software/float_bits.h"

static void clamp_row(float *restrict v, int count) {
    for (int i = 0; i < count; i++)
        v[i] = gscl_lesser_positive(gscl_positive_part(v[i]), 1.0f);
}

/* Clamps a colour to alpha and, unless it stays premultiplied, divides it by alpha; 0 where alpha is 0. */
static void divide_row(float *restrict v, const float *restrict alpha, bool premultiplied, int count) {
    const float smallest = 0x1p-100f;
    for (int i = 0; i < count; i++)
        v[i] = gscl_lesser_positive(v[i], alpha[i]);
    for (int i = 0; i < count && !premultiplied; i++)
        v[i] /= gscl_larger_positive(alpha[i], smallest);
}

static const float half = 0.5f; /* positive numbers are rounded by truncation */

/* Stores one channel, its samples `stride` bytes apart; `v` is NULL for a channel of ones.  Rows of the caller may begin at
 * any address, where many processors store no number of several bytes. */
static void store_u8(const float *v, unsigned char *to, size_t stride, int count) {
    for (int i = 0; i < count; i++)
        to[(size_t)i * stride] = v ? (uint8_t)(int)(v[i] * 255.0f + half) : 255;
}
static void store_u16(const float *v, unsigned char *to, size_t stride, int count) {
    for (int i = 0; i < count; i++) {
        const uint16_t sample = v ? (uint16_t)(int)(v[i] * 65535.0f + half) : 65535;
        memcpy(to + (size_t)i * stride, &sample, sizeof sample);
    }
}
static void store_f32(const float *v, unsigned char *to, size_t stride, int count) {
    for (int i = 0; i < count; i++) {
        const float sample = v ? v[i] : 1.0f;
        memcpy(to + (size_t)i * stride, &sample, sizeof sample);
    }
}

static void store_channel(const gscl_image *image, const float *v, uint32_t channel, int count, void *pixels) {
    const size_t size = gscl_sample_size(image->sample);
    unsigned char *to = (unsigned char *)pixels + channel * size;
    if (image->sample == GSCL_SAMPLE_U8)
        store_u8(v, to, image->channels * size, count);
    else if (image->sample == GSCL_SAMPLE_U16)
        store_u16(v, to, image->channels * size, count);
    else
        store_f32(v, to, image->channels * size, count);
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
