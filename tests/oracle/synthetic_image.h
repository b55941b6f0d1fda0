/* Small synthetic images for tests. */
#ifndef GSCL_SYNTHETIC_IMAGE_H
#define GSCL_SYNTHETIC_IMAGE_H

#include <gscl/gscl.h>

typedef enum {
    SYNTHETIC_GRADIENT,
    SYNTHETIC_NOISE,
    SYNTHETIC_SHAPES,
    SYNTHETIC_FLAT,
    SYNTHETIC_TEXTURE
} synthetic_image_kind;

/* An image with packed rows; NULL pixels when memory runs out.  Samples are U8, U16 or F32.  Released with
 * synthetic_image_free. */
gscl_image synthetic_image(synthetic_image_kind kind, uint32_t width, uint32_t height, uint32_t channels,
                           gscl_sample sample);
void synthetic_image_free(gscl_image *image);

/* Bytes of a sample. */
size_t synthetic_sample_size(gscl_sample sample);
/* Samples of the image's pixels: width * height * channels. */
size_t synthetic_sample_count(const gscl_image *image);
/* A sample of a packed image in 0..1. */
double synthetic_sample(const gscl_image *image, size_t index);

#endif
