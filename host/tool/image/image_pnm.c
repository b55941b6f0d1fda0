#define _DEFAULT_SOURCE /* strcasecmp */
#include "image/image_pnm.h"

#include <stdio.h>
#include <strings.h>

bool image_is_pnm_name(const char *name) {
    const char *suffix = name_suffix(name);
    return strcasecmp(suffix, ".pgm") == 0 || strcasecmp(suffix, ".ppm") == 0 || strcasecmp(suffix, ".pnm") == 0;
}

/* The most significant byte comes first. */
static bool write_u16(output_file *output, const uint16_t *samples, size_t count) {
    uint8_t bytes[4096];
    size_t used = 0;
    for (size_t i = 0; i < count; i++) {
        bytes[used++] = (uint8_t)(samples[i] >> 8);
        bytes[used++] = (uint8_t)samples[i];
        if (used == sizeof bytes || i + 1 == count) {
            if (!output_write(output, bytes, used))
                return false;
            used = 0;
        }
    }
    return true;
}

bool image_write_pnm(output_file *output, const gscl_image *image) {
    const bool high_bit_depth = image->sample == GSCL_SAMPLE_U16;
    const size_t samples = (size_t)image->width * image->height * image->channels;
    char header[64];
    const int length = snprintf(header, sizeof header, "P%c\n%u %u\n%d\n", image->channels == 1 ? '5' : '6',
                                image->width, image->height, high_bit_depth ? 65535 : 255);
    if (!output_write(output, header, (size_t)length))
        return false;
    return high_bit_depth ? write_u16(output, image->pixels, samples) : output_write(output, image->pixels, samples);
}
