#include "synthetic_image.h"

#include <math.h>
#include <stdlib.h>

static uint32_t hash(uint32_t x, uint32_t y, uint32_t c) {
    uint32_t h = x * 0x9E3779B1u ^ y * 0x85EBCA77u ^ c * 0xC2B2AE3Du;
    h = (h ^ h >> 15) * 0x2C1B3C6Du;
    h = (h ^ h >> 12) * 0x297A2D39u;
    return h ^ h >> 15;
}

static double noise(uint32_t x, uint32_t y, uint32_t c) {
    return (hash(x, y, c) >> 8) / 16777215.0;
}

/* A disc, a bar and a slanted line over a ramp. */
static double shapes(double u, double v, uint32_t c) {
    if (hypot(u - 0.35, v - 0.4) < 0.22)
        return c == 0 ? 0.9 : 0.15;
    if (u > 0.6 && u < 0.9 && v > 0.2 && v < 0.45)
        return c == 1 ? 0.8 : 0.3;
    if (fabs(u + v - 1.3) < 0.02)
        return 1.0;
    return 0.2 + 0.3 * v;
}

/* Texture of several scales: the error falls with every further splat. */
static double texture(uint32_t x, uint32_t y, uint32_t c) {
    const double a = noise(x / 13, y / 11, c), b = noise(x / 5, y / 5, c + 7), d = noise(x / 2, y / 2, 23);
    return 0.5 * a + 0.3 * b + 0.2 * d;
}

static double colour(synthetic_image_kind kind, uint32_t x, uint32_t y, uint32_t c, double u, double v) {
    switch (kind) {
    case SYNTHETIC_GRADIENT:
        return c == 0 ? u : c == 1 ? v : 1.0 - 0.5 * (u + v);
    case SYNTHETIC_NOISE:
        return noise(x, y, c);
    case SYNTHETIC_SHAPES:
        return shapes(u, v, c);
    case SYNTHETIC_TEXTURE:
        return texture(x, y, c);
    case SYNTHETIC_FLAT:
        break;
    }
    return 0.2 * (c + 1);
}

/* Opaque in the middle, transparent at the corners. */
static double opacity(synthetic_image_kind kind, double u, double v) {
    if (kind == SYNTHETIC_FLAT)
        return 0.6;
    return fmin(fmax(1.6 - 2.4 * hypot(u - 0.5, v - 0.5), 0.0), 1.0);
}

size_t synthetic_sample_size(gscl_sample sample) {
    return sample == GSCL_SAMPLE_U8 ? 1 : sample == GSCL_SAMPLE_U16 ? 2 : 4;
}

size_t synthetic_sample_count(const gscl_image *image) {
    return (size_t)image->width * image->height * image->channels;
}

static void put(gscl_image *image, size_t index, double value) {
    if (image->sample == GSCL_SAMPLE_U8)
        ((uint8_t *)image->pixels)[index] = (uint8_t)(value * 255.0 + 0.5);
    else if (image->sample == GSCL_SAMPLE_U16)
        ((uint16_t *)image->pixels)[index] = (uint16_t)(value * 65535.0 + 0.5);
    else
        ((float *)image->pixels)[index] = (float)value;
}

double synthetic_sample(const gscl_image *image, size_t index) {
    if (image->sample == GSCL_SAMPLE_U8)
        return ((const uint8_t *)image->pixels)[index] / 255.0;
    if (image->sample == GSCL_SAMPLE_U16)
        return ((const uint16_t *)image->pixels)[index] / 65535.0;
    return ((const float *)image->pixels)[index];
}

gscl_image synthetic_image(synthetic_image_kind kind, uint32_t width, uint32_t height, uint32_t channels,
                           gscl_sample sample) {
    gscl_image image = {.width = width, .height = height, .channels = channels, .sample = sample};
    image.pixels = calloc(synthetic_sample_count(&image), synthetic_sample_size(sample));
    if (!image.pixels)
        return image;
    const uint32_t colours = channels >= 3 ? 3 : 1;
    size_t index = 0;
    for (uint32_t y = 0; y < height; y++) {
        for (uint32_t x = 0; x < width; x++) {
            const double u = (x + 0.5) / width, v = (y + 0.5) / height;
            for (uint32_t c = 0; c < colours; c++)
                put(&image, index++, colour(kind, x, y, c, u, v));
            if (channels > colours)
                put(&image, index++, opacity(kind, u, v));
        }
    }
    return image;
}

void synthetic_image_free(gscl_image *image) {
    free(image->pixels);
    image->pixels = NULL;
}
