/* Small synthetic pictures for tests. */
#ifndef GSCL_TEST_IMAGE_H
#define GSCL_TEST_IMAGE_H

#include <gscl/gscl.h>

typedef enum { TEST_GRADIENT, TEST_NOISE, TEST_SHAPES, TEST_FLAT, TEST_BUSY } test_image_kind;

/* An image with packed rows; NULL pixels when there is no memory.  Samples are U8, U16 or F32.  Released with
 * test_image_free. */
gscl_image test_image(test_image_kind kind, uint32_t width, uint32_t height, uint32_t channels, gscl_sample sample);
void test_image_free(gscl_image *image);

/* Bytes of a sample. */
size_t test_sample_size(gscl_sample sample);
/* Samples of the image's pixels: width * height * channels. */
size_t test_sample_count(const gscl_image *image);
/* A sample of a packed image in 0..1. */
double test_sample(const gscl_image *image, size_t index);

#endif
