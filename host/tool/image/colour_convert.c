#include "image/colour_convert.h"

#include <stdint.h>
#include <stdlib.h>

/* A conversion of an image, row by row. */
typedef struct conversion {
    cmsHTRANSFORM transform;
    const gscl_image *image;
    unsigned image_colours, from, to; /* channels without alpha: of the image, of the profile, of the result */
    unsigned result_colours;          /* of the result that are stored: one of three for a grey image */
    bool inks;
    float *source, *result, *alpha; /* one row each */
} conversion;

static float load_sample(const gscl_image *image, size_t at) {
    switch (image->sample) {
    case GSCL_SAMPLE_U8:
        return ((const uint8_t *)image->pixels)[at] / 255.0f;
    case GSCL_SAMPLE_U16:
        return ((const uint16_t *)image->pixels)[at] / 65535.0f;
    default:
        return ((const float *)image->pixels)[at];
    }
}

static void store_sample(const gscl_image *image, size_t at, float value) {
    const float clamped = value > 0.0f ? value < 1.0f ? value : 1.0f : 0.0f;
    switch (image->sample) {
    case GSCL_SAMPLE_U8:
        ((uint8_t *)image->pixels)[at] = (uint8_t)(clamped * 255.0f + 0.5f);
        break;
    case GSCL_SAMPLE_U16:
        ((uint16_t *)image->pixels)[at] = (uint16_t)(clamped * 65535.0f + 0.5f);
        break;
    default: /* beyond 0..1 too, as in a file of linear light */
        ((float *)image->pixels)[at] = value;
    }
}

static void load_row(const conversion *c, uint32_t y) {
    const gscl_image *image = c->image;
    const bool has_alpha = image->channels > c->image_colours;
    size_t at = (size_t)y * image->width * image->channels;
    for (uint32_t x = 0; x < image->width; x++, at += image->channels) {
        c->alpha[x] = has_alpha ? load_sample(image, at + c->image_colours) : 1.0f;
        const float divisor = image->premultiplied && c->alpha[x] > 0.0f ? c->alpha[x] : 1.0f;
        for (unsigned i = 0; i < c->from; i++) {
            const float value = load_sample(image, at + (i < c->image_colours ? i : 0)) / divisor;
            c->source[(size_t)x * c->from + i] = c->inks ? 100.0f * value : value;
        }
    }
}

/* Results are at most as long as the row that they replace, so that no row is overwritten before it is read. */
static void store_row(const conversion *c, uint32_t y) {
    const bool has_alpha = c->image->channels > c->image_colours;
    const unsigned channels = c->result_colours + (has_alpha ? 1 : 0);
    size_t at = (size_t)y * c->image->width * channels;
    for (uint32_t x = 0; x < c->image->width; x++, at += channels) {
        for (unsigned i = 0; i < c->result_colours; i++)
            store_sample(c->image, at + i, c->result[(size_t)x * c->to + i]);
        if (has_alpha)
            store_sample(c->image, at + c->result_colours, c->alpha[x]);
    }
}

static void convert_rows(const conversion *c) {
    for (uint32_t y = 0; y < c->image->height; y++) {
        load_row(c, y);
        cmsDoTransform(c->transform, c->source, c->result, c->image->width);
        store_row(c, y);
    }
}

static bool convert_image(const colour_profile *from, const colour_profile *to, gscl_image *image) {
    conversion c = {.image = image, .from = from->channels, .to = to->channels, .inks = from->channels == 4};
    c.image_colours = c.inks ? 4 : image->channels <= 2 ? 1 : 3;
    c.result_colours = c.image_colours == 1 ? 1 : to->channels;
    c.transform = colour_profile_conversion(from, to);
    c.source = malloc((size_t)image->width * (c.from + c.to + 1) * sizeof(float));
    const bool ok = c.transform && c.source;
    if (ok) {
        c.result = c.source + (size_t)image->width * c.from;
        c.alpha = c.result + (size_t)image->width * c.to;
        convert_rows(&c);
        image->channels = c.inks ? 3 : image->channels;
        image->premultiplied = false;
    }
    free(c.source);
    if (c.transform)
        cmsDeleteTransform(c.transform);
    return ok;
}

bool colour_convert_to_srgb(const colour_profile *profile, gscl_image *image) {
    colour_profile srgb;
    if (!colour_profile_open_srgb(&srgb, profile->channels == 1 ? 1 : 3))
        return false;
    const bool ok = convert_image(profile, &srgb, image);
    colour_profile_close(&srgb);
    return ok;
}
