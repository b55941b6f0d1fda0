#include "image/image.h"

#include <math.h>
#include <string.h>

size_t gscl_sample_size(gscl_sample sample) {
    return sample == GSCL_SAMPLE_U8 ? 1 : sample == GSCL_SAMPLE_U16 ? 2 : 4;
}

size_t gscl_image_stride(const gscl_image *image) {
    return image->stride ? image->stride : (size_t)image->width * image->channels * gscl_sample_size(image->sample);
}

static const unsigned char *row_of(const gscl_image *image, uint32_t y) {
    return (const unsigned char *)image->pixels + (size_t)y * gscl_image_stride(image);
}

static float sample_at(const unsigned char *row, gscl_sample sample, size_t i) {
    if (sample == GSCL_SAMPLE_U8)
        return (float)row[i] / 255.0f;
    if (sample == GSCL_SAMPLE_U16)
        return (float)((const uint16_t *)(const void *)row)[i] / 65535.0f;
    return ((const float *)(const void *)row)[i];
}

static float clamp_unit(float x) {
    return x < 0.0f ? 0.0f : x > 1.0f ? 1.0f : x;
}

static bool has_alpha(const gscl_image *image) {
    return image->channels == 2 || image->channels == 4;
}

/* Clamped to 0..1 and premultiplied. */
static gscl_pixel pixel_at(const gscl_image *image, const unsigned char *row, uint32_t x) {
    gscl_pixel p;
    size_t at = (size_t)x * image->channels;
    int colours = image->channels >= 3 ? 3 : 1;
    p.alpha = has_alpha(image) ? clamp_unit(sample_at(row, image->sample, at + (size_t)colours)) : 1.0f;
    float factor = image->premultiplied ? 1.0f : p.alpha;
    for (int k = 0; k < 3; k++) {
        float c = clamp_unit(sample_at(row, image->sample, at + (size_t)(k < colours ? k : 0))) * factor;
        p.colour[k] = c < p.alpha ? c : p.alpha;
    }
    return p;
}

gscl_pixel gscl_image_pixel(const gscl_image *image, uint32_t x, uint32_t y) {
    return pixel_at(image, row_of(image, y), x);
}

static gscl_result check_kind(gscl_context *context, const gscl_image *image) {
    if (!image || !image->pixels)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "there is no image");
    if (image->width < 1 || image->height < 1 || image->width > GSCL_MAX_DIMENSION ||
        image->height > GSCL_MAX_DIMENSION)
        return gscl_fail(context, GSCL_ERROR_IMAGE_SIZE, "the image is %ux%u pixels; 1x1 to %dx%d can be encoded",
                         image->width, image->height, GSCL_MAX_DIMENSION, GSCL_MAX_DIMENSION);
    if (image->channels < 1 || image->channels > 4)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "the image has %u channels; 1 to 4 can be encoded",
                         image->channels);
    if (image->sample < GSCL_SAMPLE_U8 || image->sample > GSCL_SAMPLE_F32)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "unknown sample type %d", (int)image->sample);
    if (gscl_image_stride(image) < (size_t)image->width * image->channels * gscl_sample_size(image->sample))
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "the stride of %zu bytes is shorter than a row",
                         image->stride);
    return GSCL_OK;
}

static gscl_result check_finite(gscl_context *context, const gscl_image *image) {
    if (image->sample != GSCL_SAMPLE_F32)
        return GSCL_OK;
    for (uint32_t y = 0; y < image->height; y++) {
        const float *row = (const float *)(const void *)row_of(image, y);
        for (size_t i = 0; i < (size_t)image->width * image->channels; i++)
            if (!isfinite(row[i]))
                return gscl_fail(context, GSCL_ERROR_IMAGE_NOT_FINITE, "pixel (%u, %u) is %s; samples must be finite",
                                 (unsigned)(i / image->channels), y, isnan(row[i]) ? "NaN" : "infinite");
    }
    return GSCL_OK;
}

gscl_result gscl_image_examine(gscl_context *context, const gscl_image *image, gscl_content *content) {
    GSCL_TRY(check_kind(context, image));
    GSCL_TRY(check_finite(context, image));
    gscl_pixel first = gscl_image_pixel(image, 0, 0);
    *content = (gscl_content){.flat = true, .high_bit_depth = image->sample != GSCL_SAMPLE_U8};
    for (uint32_t y = 0; y < image->height; y++) {
        const unsigned char *row = row_of(image, y);
        for (uint32_t x = 0; x < image->width; x++) {
            gscl_pixel p = pixel_at(image, row, x);
            if (p.colour[0] != p.colour[1] || p.colour[1] != p.colour[2])
                content->chroma = true;
            if (p.alpha < 1.0f)
                content->alpha = true;
            if (memcmp(&p, &first, sizeof p) != 0)
                content->flat = false;
        }
    }
    return GSCL_OK;
}

void gscl_image_to_planes(const gscl_image *image, int colours, bool alpha, int level, float *planes) {
    uint32_t width = gscl_level_size(image->width, level), height = gscl_level_size(image->height, level);
    uint32_t side = 1u << level;
    size_t plane = (size_t)width * height;
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            float sum[4] = {0}, count = 0;
            for (uint32_t v = y * side; v < (y + 1) * side && v < image->height; v++)
                for (uint32_t u = x * side; u < (x + 1) * side && u < image->width; u++) {
                    gscl_pixel p = pixel_at(image, row_of(image, v), u);
                    if (colours == 1) /* exact where the colours are equal */
                        p.colour[0] += ((p.colour[1] - p.colour[0]) + (p.colour[2] - p.colour[0])) / 3.0f;
                    for (int k = 0; k < colours; k++)
                        sum[k] += p.colour[k];
                    sum[3] += p.alpha;
                    count += 1.0f;
                }
            float *to = planes + (size_t)y * width + x;
            for (int k = 0; k < colours; k++)
                to[(size_t)k * plane] = sum[k] / count;
            if (alpha)
                to[(size_t)colours * plane] = sum[3] / count;
        }
}
