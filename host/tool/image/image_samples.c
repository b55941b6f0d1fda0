#include "image/image_samples.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

size_t image_sample_size(gscl_sample sample) {
    return sample == GSCL_SAMPLE_U8 ? 1 : sample == GSCL_SAMPLE_U16 ? 2 : 4;
}

static size_t pixel_count(const gscl_image *image) {
    return (size_t)image->width * image->height;
}

void image_invert_colours(gscl_image *image) {
    const size_t samples = pixel_count(image) * image->channels;
    const uint32_t alpha = image->channels % 2 == 0 ? image->channels - 1 : image->channels;
    for (size_t i = 0; i < samples; i++) {
        if (i % image->channels == alpha)
            continue;
        if (image->sample == GSCL_SAMPLE_U8)
            ((uint8_t *)image->pixels)[i] = (uint8_t)(255 - ((uint8_t *)image->pixels)[i]);
        else if (image->sample == GSCL_SAMPLE_U16)
            ((uint16_t *)image->pixels)[i] = (uint16_t)(65535 - ((uint16_t *)image->pixels)[i]);
        else
            ((float *)image->pixels)[i] = 1.0f - ((float *)image->pixels)[i];
    }
}

bool image_alpha_is_clear(const gscl_image *image) {
    static const float zero = 0.0f;
    const size_t size = image_sample_size(image->sample), pixel = size * image->channels;
    const uint8_t *alpha = (const uint8_t *)image->pixels + pixel - size;
    for (size_t left = pixel_count(image); left > 0; left--, alpha += pixel) {
        if (memcmp(alpha, &zero, size) != 0)
            return false;
    }
    return true;
}

void image_drop_alpha(gscl_image *image) {
    const size_t size = image_sample_size(image->sample), pixel = size * image->channels;
    uint8_t *to = image->pixels;
    const uint8_t *from = image->pixels;
    for (size_t left = pixel_count(image); left > 0; left--, to += pixel - size, from += pixel)
        memmove(to, from, pixel - size);
    image->channels--;
    image->premultiplied = false;
}

bool image_add_alpha(gscl_image *image) {
    const size_t channels = image->channels;
    uint8_t *pixels = malloc(pixel_count(image) * (channels + 1));
    if (!pixels)
        return false;
    const uint8_t *from = image->pixels;
    uint8_t *to = pixels;
    for (size_t left = pixel_count(image); left > 0; left--, from += channels, to += channels + 1) {
        memcpy(to, from, channels);
        to[channels] = 255;
    }
    free(image->pixels);
    image->pixels = pixels;
    image->channels++;
    return true;
}
