#include "image/image_alpha.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "cli/message.h"

static bool has_alpha(unsigned channels) {
    return channels % 2 == 0;
}

static bool is_grey(const option_colour *colour) {
    return colour->rgb[0] == colour->rgb[1] && colour->rgb[1] == colour->rgb[2];
}

unsigned image_written_channels(unsigned channels, const image_format *format, const option_colour *background) {
    if (!has_alpha(channels) || (format->alpha && !background))
        return channels;
    return channels == 2 && (!background || is_grey(background)) ? 1 : 3;
}

/* ---- Samples ----------------------------------------------------------------------------------- */

/* The sample of 1. */
static double peak_of(const gscl_image *image) {
    return image->sample == GSCL_SAMPLE_U8 ? 255.0 : image->sample == GSCL_SAMPLE_U16 ? 65535.0 : 1.0;
}

static double load_sample(const gscl_image *image, size_t at) {
    switch (image->sample) {
    case GSCL_SAMPLE_U8:
        return ((const uint8_t *)image->pixels)[at];
    case GSCL_SAMPLE_U16:
        return ((const uint16_t *)image->pixels)[at];
    default:
        return (double)((const float *)image->pixels)[at];
    }
}

/* The peaks of whole numbers are odd, so that no blended value lies in the middle between two. */
static void store_sample(const gscl_image *image, size_t at, double value) {
    switch (image->sample) {
    case GSCL_SAMPLE_U8:
        ((uint8_t *)image->pixels)[at] = (uint8_t)floor(value + 0.5);
        break;
    case GSCL_SAMPLE_U16:
        ((uint16_t *)image->pixels)[at] = (uint16_t)floor(value + 0.5);
        break;
    default:
        ((float *)image->pixels)[at] = (float)value;
    }
}

static size_t sample_bytes(gscl_sample sample) {
    return sample == GSCL_SAMPLE_U8 ? 1 : sample == GSCL_SAMPLE_U16 ? 2 : sizeof(float);
}

/* ---- Images ------------------------------------------------------------------------------------ */

static bool is_opaque(const gscl_image *image) {
    const size_t samples = (size_t)image->width * image->height * image->channels;
    const double peak = peak_of(image);
    for (size_t at = image->channels - 1; at < samples; at += image->channels) {
        if (load_sample(image, at) < peak)
            return false;
    }
    return true;
}

static void blend_pixels(const gscl_image *image, const uint8_t rgb[3], const gscl_image *flat) {
    const size_t pixels = (size_t)image->width * image->height;
    const double peak = peak_of(image);
    for (size_t i = 0; i < pixels; i++) {
        const size_t from = i * image->channels, to = i * flat->channels;
        const double alpha = load_sample(image, from + image->channels - 1);
        for (unsigned c = 0; c < flat->channels; c++) {
            const double front = load_sample(image, from + (image->channels == 4 ? c : 0));
            const double back = rgb[c] * peak / 255.0;
            store_sample(flat, to + c, (front * alpha + back * (peak - alpha)) / peak);
        }
    }
}

bool image_flatten(const char *label, const image_format *format, const option_colour *background,
                   const gscl_image *image, gscl_image *flat) {
    static const option_colour unseen = {{0, 0, 0}};
    *flat = *image;
    flat->pixels = NULL;
    flat->channels = image_written_channels(image->channels, format, background);
    if (flat->channels == image->channels)
        return true;
    if (!background && !is_opaque(image))
        return report_error(label,
                            "%s cannot hold an alpha channel; add --background COLOUR, or choose .png, .tif, .exr or "
                            ".tga",
                            format->suffix);
    flat->pixels = malloc((size_t)image->width * image->height * flat->channels * sample_bytes(image->sample));
    if (!flat->pixels)
        return report_error(label, "is too large for the available memory");
    blend_pixels(image, (background ? background : &unseen)->rgb, flat);
    return true;
}
