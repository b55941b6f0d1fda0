/* "Rendering". */
#include <math.h>

#include "oracle.h"

static const double pi = 3.14159265358979323846;

/* The value of a splat at a point: 0 beyond its border. */
static double splat_value(const oracle_splat *splat, double x, double y) {
    const double dx = x - splat->x, dy = y - splat->y;
    const double c = cos(splat->theta), s = sin(splat->theta);
    const double along = (dx * c + dy * s) / splat->s1, across = (dy * c - dx * s) / splat->s2;
    const double q = 0.5 * (along * along + across * across);
    return fmax(0.0, exp(-q) - exp(-7.0));
}

/* Blends one more splat into a pixel.  `weight` is the sum of the weights so far, of the normalized blend. */
static void blend_splat(oracle_blend blend, const double *colour, double strength, uint32_t channels, double *value,
                        double *weight) {
    const double a = fmin(strength, 0.999);
    *weight += strength;
    for (uint32_t c = 0; c < channels; c++) {
        if (blend == ORACLE_ALPHA)
            value[c] = value[c] * (1.0 - a) + colour[c] * a;
        else
            value[c] += strength * colour[c];
    }
}

/* The colour of a splat at a point. */
static void splat_colour(const oracle_header *header, const oracle_splat *splat, double x, double y, double *colour) {
    double wave = 0.0;
    if (splat->amplitude > 0.0) {
        const double along = (x - splat->x) * cos(splat->direction) + (y - splat->y) * sin(splat->direction);
        wave = splat->amplitude * cos(2.0 * pi * along / splat->wavelength - splat->phase);
    }
    for (uint32_t c = 0; c < header->channels; c++)
        colour[c] = splat->colour[c] + (c < header->colours ? wave : 0.0);
}

/* The pixels whose centres may lie within `reach` of `at`: from *first up to, but without, *end. */
static void span(double at, double reach, uint32_t size, uint32_t *first, uint32_t *end) {
    *first = (uint32_t)fmin(fmax(floor(at - reach - 1.0), 0.0), size);
    *end = (uint32_t)fmin(fmax(ceil(at + reach + 1.0), 0.0), size);
}

static void draw_splat(const oracle_image *image, const oracle_splat *splat, double *values, double *weights) {
    const oracle_header *header = &image->header;
    const double reach = sqrt(14.0) * fmax(splat->s1, splat->s2);
    uint32_t left, right, top, bottom;
    span(splat->x, reach, header->width, &left, &right);
    span(splat->y, reach, header->height, &top, &bottom);
    for (uint32_t j = top; j < bottom; j++) {
        for (uint32_t i = left; i < right; i++) {
            const double strength = splat->opacity * splat_value(splat, i + 0.5, j + 0.5);
            const size_t pixel = (size_t)j * header->width + i;
            double colour[ORACLE_CHANNELS];
            if (strength <= 0.0)
                continue;
            splat_colour(header, splat, i + 0.5, j + 0.5, colour);
            blend_splat(header->blend, colour, strength, header->channels, &values[pixel * header->channels],
                        &weights[pixel]);
        }
    }
}

void oracle_draw(const oracle_image *image, double *values, double *weights) {
    const oracle_header *header = &image->header;
    const size_t pixels = (size_t)header->width * header->height;
    const bool normalized = header->blend == ORACLE_NORMALIZED;
    const double e = 1.0 / 1024.0;
    for (size_t i = 0; i < pixels; i++) {
        weights[i] = e;
        for (uint32_t c = 0; c < header->channels; c++)
            values[i * header->channels + c] = image->background[c] * (normalized ? e : 1.0);
    }
    for (uint32_t i = 0; i < header->splats; i++)
        draw_splat(image, &image->splats[i], values, weights);
    for (size_t i = 0; normalized && i < pixels; i++) {
        for (uint32_t c = 0; c < header->channels; c++)
            values[i * header->channels + c] /= weights[i];
    }
}

static double clamp(double value, double high) {
    return fmin(fmax(value, 0.0), high);
}

void oracle_output(const oracle_image *image, const double *values, double *pixels) {
    const oracle_header *header = &image->header;
    const size_t count = (size_t)header->width * header->height;
    const bool has_alpha_sample = header->layout & 1;
    const uint32_t colours = header->layout >= 2 ? 3 : 1;
    for (size_t i = 0; i < count; i++) {
        const double *coded = &values[i * header->channels];
        double *out = &pixels[i * (colours + (has_alpha_sample ? 1 : 0))];
        const double alpha = header->has_alpha ? clamp(coded[header->colours], 1.0) : 1.0;
        for (uint32_t c = 0; c < colours; c++) {
            const double colour = clamp(coded[header->has_chroma ? c : 0], alpha);
            out[c] = alpha > 0.0 ? colour / alpha : 0.0;
        }
        if (has_alpha_sample)
            out[colours] = alpha;
    }
}

uint32_t oracle_round(double sample, uint32_t peak) {
    return (uint32_t)floor(sample * peak + 0.5);
}
