#include "image/image.h"

#include <math.h>
#include <string.h>

size_t gscl_sample_size(gscl_sample sample) {
    return sample == GSCL_SAMPLE_U8 ? 1 : sample == GSCL_SAMPLE_U16 ? 2 : 4;
}

size_t gscl_image_row_size(const gscl_image *image) {
    return (size_t)image->width * image->channels * gscl_sample_size(image->sample);
}

ptrdiff_t gscl_image_stride(const gscl_image *image) {
    return image->stride ? image->stride : (ptrdiff_t)gscl_image_row_size(image);
}

unsigned char *gscl_image_row(const gscl_image *image, uint32_t y) {
    return (unsigned char *)image->pixels + (ptrdiff_t)y * gscl_image_stride(image);
}

gscl_image gscl_image_rows(const gscl_image *image, uint32_t y, uint32_t count) {
    gscl_image rows = *image;
    rows.height = count;
    rows.stride = gscl_image_stride(image);
    rows.pixels = gscl_image_row(image, y);
    return rows;
}

bool gscl_image_rows_fit(const gscl_image *image) {
    const size_t stride = (size_t)gscl_image_stride(image), row = gscl_image_row_size(image);
    return (image->stride < 0 ? -stride : stride) >= row;
}

uint32_t gscl_layout_channels(gscl_layout layout) {
    static const uint8_t channels[] = {[GSCL_LAYOUT_GREY] = 1, [GSCL_LAYOUT_GREY_ALPHA] = 2, [GSCL_LAYOUT_RGB] = 3,
                                       [GSCL_LAYOUT_RGBA] = 4, [GSCL_LAYOUT_BGR] = 3,        [GSCL_LAYOUT_BGRA] = 4};
    return (size_t)layout < sizeof channels ? channels[layout] : 0;
}

bool gscl_image_has_layout(const gscl_image *image) {
    return image->layout == GSCL_LAYOUT_AUTO || gscl_layout_channels(image->layout) == image->channels;
}

static float clamp_unit(float x) {
    return x < 0.0f ? 0.0f : x > 1.0f ? 1.0f : x;
}

/* Sample number i of a row, which may begin at any address. */
static uint16_t u16_at(const unsigned char *row, size_t i) {
    uint16_t sample;
    memcpy(&sample, row + i * sizeof sample, sizeof sample);
    return sample;
}
static float f32_at(const unsigned char *row, size_t i) {
    float sample;
    memcpy(&sample, row + i * sizeof sample, sizeof sample);
    return sample;
}

/* `count` samples from number `first` of a row on, clamped to 0..1. */
static void read_samples(const unsigned char *row, gscl_sample sample, size_t first, size_t count, float *values) {
    if (sample == GSCL_SAMPLE_U8)
        for (size_t i = 0; i < count; i++)
            values[i] = (float)row[first + i] / 255.0f;
    else if (sample == GSCL_SAMPLE_U16)
        for (size_t i = 0; i < count; i++)
            values[i] = (float)u16_at(row, first + i) / 65535.0f;
    else
        for (size_t i = 0; i < count; i++)
            values[i] = clamp_unit(f32_at(row, first + i));
}

void gscl_image_read(const gscl_image *image, uint32_t x, uint32_t y, size_t count, gscl_pixels *pixels) {
    const size_t channels = image->channels, colours = channels >= 3 ? 3 : 1;
    const bool has_alpha = channels % 2 == 0, is_bgr = gscl_layout_is_bgr(image->layout);
    float values[4 * GSCL_MAX_READ] = {0}; /* set for analysers, which cannot tell that all that is used is read */
    read_samples(gscl_image_row(image, y), image->sample, x * channels, count * channels, values);
    for (size_t i = 0; i < count; i++)
        pixels->alpha[i] = has_alpha ? values[i * channels + colours] : 1.0f;
    for (size_t k = 0; k < 3; k++) {
        const float *colour = values + (colours == 1 ? 0 : is_bgr ? 2 - k : k);
        for (size_t i = 0; i < count; i++) {
            const float alpha = pixels->alpha[i], c = colour[i * channels] * (image->premultiplied ? 1.0f : alpha);
            pixels->colour[k][i] = c < alpha ? c : alpha;
        }
    }
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
    if (!gscl_image_has_layout(image))
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT,
                         "the layout %d of the image is none of %u channels; GSCL_LAYOUT_AUTO takes the usual one",
                         (int)image->layout, image->channels);
    if (!gscl_image_rows_fit(image))
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT,
                         "the stride of %td bytes is shorter than a row, which has %zu", image->stride,
                         gscl_image_row_size(image));
    return GSCL_OK;
}

static gscl_result check_finite(gscl_context *context, const gscl_image *image) {
    if (image->sample != GSCL_SAMPLE_F32)
        return GSCL_OK;
    for (uint32_t y = 0; y < image->height; y++) {
        const unsigned char *row = gscl_image_row(image, y);
        for (size_t i = 0; i < (size_t)image->width * image->channels; i++)
            if (!isfinite(f32_at(row, i)))
                return gscl_fail(context, GSCL_ERROR_IMAGE_NOT_FINITE, "pixel (%u, %u) is %s; samples must be finite",
                                 (unsigned)(i / image->channels), y, isnan(f32_at(row, i)) ? "NaN" : "infinite");
    }
    return GSCL_OK;
}

/* Notes what these pixels say of the content.  `first`: the first pixel of the image. */
static void examine_pixels(const gscl_pixels *p, size_t count, const gscl_pixels *first, gscl_content *content) {
    for (size_t i = 0; i < count; i++) {
        const float red = p->colour[0][i], green = p->colour[1][i], blue = p->colour[2][i], alpha = p->alpha[i];
        content->chroma |= red != green || green != blue;
        content->alpha |= alpha < 1.0f;
        content->flat &= red == first->colour[0][0] && green == first->colour[1][0] && blue == first->colour[2][0] &&
                         alpha == first->alpha[0];
    }
}

gscl_result gscl_image_examine(gscl_context *context, const gscl_image *image, gscl_content *content) {
    gscl_pixels first, pixels;
    GSCL_TRY(check_kind(context, image));
    GSCL_TRY(check_finite(context, image));
    gscl_image_read(image, 0, 0, 1, &first);
    *content = (gscl_content){.flat = true, .high_bit_depth = image->sample != GSCL_SAMPLE_U8};
    for (uint32_t y = 0; y < image->height; y++)
        for (uint32_t x = 0; x < image->width; x += GSCL_MAX_READ) {
            const size_t count = gscl_image_read_count(image, x);
            gscl_image_read(image, x, y, count, &pixels);
            examine_pixels(&pixels, count, &first, content);
        }
    return GSCL_OK;
}

/* Replaces three colours by their mean, which is exact where they are equal. */
static void make_grey(gscl_pixels *p, size_t count) {
    float *grey = p->colour[0];
    for (size_t i = 0; i < count; i++)
        grey[i] += ((p->colour[1][i] - grey[i]) + (p->colour[2][i] - grey[i])) / 3.0f;
}

/* Adds pixels of a row, from `x` on, to the row of a plane in which 2^level of them are one. */
static void add_to_row(const float *values, uint32_t x, size_t count, int level, float *row) {
    if (level == 0)
        memcpy(row + x, values, count * sizeof *row);
    else
        for (size_t i = 0; i < count; i++)
            row[(x + i) >> level] += values[i];
}

/* Divides the sums of a row by the number of pixels in each.  `rows`: rows of the image in it. */
static void divide_row(float *row, uint32_t width, const gscl_image *image, int level, uint32_t rows) {
    const uint32_t side = 1u << level;
    for (uint32_t x = 0; x < width; x++) {
        const uint32_t left = image->width - x * side;
        row[x] /= (float)((left < side ? left : side) * rows);
    }
}

void gscl_image_to_planes(const gscl_image *image, int colours, bool alpha, int level, float *planes) {
    const uint32_t width = gscl_level_size(image->width, level), height = gscl_level_size(image->height, level);
    const uint32_t side = 1u << level;
    const size_t plane = (size_t)width * height;
    const int channels = colours + alpha;
    gscl_pixels pixels;
    for (int k = 0; k < channels && level > 0; k++)
        memset(planes + (size_t)k * plane, 0, plane * sizeof *planes);
    for (uint32_t y = 0; y < image->height; y++) {
        float *row = planes + (size_t)(y >> level) * width;
        for (uint32_t x = 0; x < image->width; x += GSCL_MAX_READ) {
            const size_t count = gscl_image_read_count(image, x);
            gscl_image_read(image, x, y, count, &pixels);
            if (colours == 1)
                make_grey(&pixels, count);
            for (int k = 0; k < channels; k++)
                add_to_row(k < colours ? pixels.colour[k] : pixels.alpha, x, count, level, row + (size_t)k * plane);
        }
        if (level > 0 && (y % side == side - 1 || y == image->height - 1))
            for (int k = 0; k < channels; k++)
                divide_row(row + (size_t)k * plane, width, image, level, y % side + 1);
    }
}
