/* "Rendering". */
#include <math.h>

#include "oracle.h"

static const double pi = 3.14159265358979323846;

/* The Gaussian of a splat at a point, before the cut. */
static double gaussian(const oracle_splat *splat, double x, double y) {
    const double dx = x - splat->x, dy = y - splat->y;
    const double c = cos(splat->theta), s = sin(splat->theta);
    const double along = (dx * c + dy * s) / splat->s1, across = (dy * c - dx * s) / splat->s2;
    return exp(-0.5 * (along * along + across * across));
}

/* Blends one more splat into a pixel.  `uncut` is its strength before the cut. */
static void blend_splat(oracle_blend blend, const double *colour, double strength, double uncut, uint32_t channels,
                        double *value, oracle_sums *sums) {
    const double a = fmin(strength, 0.999);
    sums->weight += strength;
    sums->magnitude = (blend == ORACLE_ALPHA ? sums->magnitude * (1.0 - a) : sums->magnitude) + uncut;
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

static void draw_splat(const oracle_image *image, const oracle_splat *splat, double *values, oracle_sums *sums) {
    const oracle_header *header = &image->header;
    const double reach = sqrt(14.0) * fmax(splat->s1, splat->s2);
    uint32_t left, right, top, bottom;
    span(splat->x, reach, header->width, &left, &right);
    span(splat->y, reach, header->height, &top, &bottom);
    for (uint32_t j = top; j < bottom; j++) {
        for (uint32_t i = left; i < right; i++) {
            const double g = gaussian(splat, i + 0.5, j + 0.5);
            const size_t pixel = (size_t)j * header->width + i;
            double colour[ORACLE_CHANNELS];
            splat_colour(header, splat, i + 0.5, j + 0.5, colour);
            blend_splat(header->blend, colour, splat->opacity * fmax(0.0, g - exp(-7.0)), splat->opacity * g,
                        header->channels, &values[pixel * header->channels], &sums[pixel]);
        }
    }
}

void oracle_draw(const oracle_image *image, double *values, oracle_sums *sums) {
    const oracle_header *header = &image->header;
    const size_t pixels = (size_t)header->width * header->height;
    const bool normalized = header->blend == ORACLE_NORMALIZED;
    const double e = 1.0 / 1024.0, of_background = normalized ? e : 1.0;
    for (size_t i = 0; i < pixels; i++) {
        sums[i] = (oracle_sums){e, of_background};
        for (uint32_t c = 0; c < header->channels; c++)
            values[i * header->channels + c] = image->background[c] * of_background;
    }
    for (uint32_t i = 0; i < header->splats; i++)
        draw_splat(image, &image->splats[i], values, sums);
    for (size_t i = 0; normalized && i < pixels; i++) {
        sums[i].magnitude /= sums[i].weight;
        for (uint32_t c = 0; c < header->channels; c++)
            values[i * header->channels + c] /= sums[i].weight;
    }
}

static double clamp(double value, double high) {
    return fmin(fmax(value, 0.0), high);
}

/* A colour sample of a coded colour and alpha. */
static double colour_sample(double colour, double alpha) {
    const double visible = clamp(alpha, 1.0);
    return visible > 0.0 ? clamp(colour, visible) / visible : 0.0;
}

/* The ranges of a pixel's samples, where coded values differ by up to `error` from those of the oracle. */
static void pixel_range(const oracle_header *header, const double *coded, double error, double *low, double *high) {
    const uint32_t colours = header->layout >= 2 ? 3 : 1;
    const double alpha = header->has_alpha ? coded[header->colours] : 1.0;
    const double low_alpha = header->has_alpha ? alpha - error : 1.0;
    const double high_alpha = header->has_alpha ? alpha + error : 1.0;
    for (uint32_t c = 0; c < colours; c++) {
        const double colour = coded[header->has_chroma ? c : 0];
        low[c] = low_alpha > 0.0 ? colour_sample(colour - error, high_alpha) : 0.0;
        high[c] = colour_sample(colour + error, fmax(low_alpha, fmin(high_alpha, 1e-12)));
    }
    if (header->layout & 1) {
        low[colours] = clamp(low_alpha, 1.0);
        high[colours] = clamp(high_alpha, 1.0);
    }
}

void oracle_output(oracle_image *image, const double *values, const oracle_sums *sums) {
    const oracle_header *header = &image->header;
    const size_t count = (size_t)header->width * header->height;
    for (size_t i = 0; i < count; i++) {
        const double *coded = &values[i * header->channels];
        double *pixel = &image->pixels[i * image->samples];
        const double tolerance = fmax(1.0, sums[i].magnitude / 4.0) / 255.0;
        pixel_range(header, coded, 0.0, pixel, pixel);
        pixel_range(header, coded, tolerance, &image->low[i * image->samples], &image->high[i * image->samples]);
    }
}

bool oracle_allows(const oracle_image *image, size_t index, double sample, uint32_t peak) {
    const double low = image->low[index], high = image->high[index];
    if (peak == 0)
        return sample >= low && sample <= high;
    return sample >= oracle_round(low, peak) && sample <= oracle_round(high, peak);
}

uint32_t oracle_round(double sample, uint32_t peak) {
    return (uint32_t)floor(sample * peak + 0.5);
}
