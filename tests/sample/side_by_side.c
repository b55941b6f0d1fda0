/* Writes two images of the same size next to each other: side_by_side LEFT RIGHT OUT.png
 *
 * Reads the image formats of the tool gscl.  Writes 8 bits per sample with the channels of the left image. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/message.h"
#include "image/image_file.h"

enum { GAP = 8 }; /* white pixels between the images */

static uint8_t to_u8(const gscl_image *image, size_t sample) {
    switch (image->sample) {
    case GSCL_SAMPLE_U16:
        return (uint8_t)((((const uint16_t *)image->pixels)[sample] * 255u + 32767u) / 65535u);
    case GSCL_SAMPLE_F32: {
        const float value = ((const float *)image->pixels)[sample];
        return (uint8_t)(255.0f * (value < 0.0f ? 0.0f : value > 1.0f ? 1.0f : value) + 0.5f);
    }
    default:
        return ((const uint8_t *)image->pixels)[sample];
    }
}

static void paste(gscl_image *target, uint32_t left, const gscl_image *source) {
    const size_t row = (size_t)source->width * source->channels;
    for (uint32_t y = 0; y < source->height; y++) {
        uint8_t *out = (uint8_t *)target->pixels + ((size_t)y * target->width + left) * target->channels;
        for (size_t i = 0; i < row; i++)
            out[i] = to_u8(source, y * row + i);
    }
}

static bool write_pair(const gscl_image *left, const gscl_image *right, const char *name) {
    gscl_image pair = *left;
    pair.width = left->width + GAP + right->width;
    pair.sample = GSCL_SAMPLE_U8;
    pair.stride = 0;
    const size_t size = (size_t)pair.width * pair.height * pair.channels;
    pair.pixels = malloc(size);
    if (!pair.pixels)
        return report_error(name, "cannot be written: out of memory");
    memset(pair.pixels, 255, size);
    paste(&pair, 0, left);
    paste(&pair, left->width + GAP, right);
    output_file output;
    const bool done = output_open(&output, name) && image_write(&output, &pair);
    free(pair.pixels);
    return done;
}

int main(int argc, char **argv) {
    gscl_image left = {0}, right = {0};
    if (argc != 4) {
        fputs("usage: side_by_side LEFT RIGHT OUT.png\n", stderr);
        return 2;
    }
    bool done = image_read(argv[1], &left) && image_read(argv[2], &right);
    if (done && (left.height != right.height || left.channels != right.channels))
        done = report_error(argv[2], "differs in height or channels from %s; give two similar images", argv[1]);
    if (done)
        done = write_pair(&left, &right, argv[3]);
    free(left.pixels);
    free(right.pixels);
    return done ? EXIT_SUCCESS : EXIT_FAILURE;
}
