/* Between the caller's interleaved images and the planar floats that the codec works on. */
#ifndef GSCL_LIB_IMAGE_H
#define GSCL_LIB_IMAGE_H

#include "runtime/context.h"

/* The properties of an image that decide which features of the codec it uses. */
typedef struct gscl_content {
    bool chroma;         /* some pixel is not grey */
    bool alpha;          /* some pixel is not opaque */
    bool flat;           /* all pixels are the same */
    bool high_bit_depth; /* more than 8 bits a sample */
} gscl_content;

/* Checks size, kind and finiteness, with a message that names the fault, and determines the content. */
gscl_result gscl_image_examine(gscl_context *context, const gscl_image *image, gscl_content *content);

/* Size of a side at a pyramid level: rounded up. */
static inline uint32_t gscl_level_size(uint32_t size, int level) {
    return (uint32_t)(((uint64_t)size + (1u << level) - 1) >> level);
}

/* Planes of the image at pyramid level `level` (averages of 2^level x 2^level pixels): 1 colour (the
 * mean of all) or 3, premultiplied by alpha, then alpha when `alpha`.  0..1.  `planes` holds them one after another. */
void gscl_image_to_planes(const gscl_image *image, int colours, bool alpha, int level, float *planes);

/* Bytes of a sample of this kind. */
size_t gscl_sample_size(gscl_sample sample);
/* Bytes of the samples of a row. */
size_t gscl_image_row_size(const gscl_image *image);
/* Bytes from row to row, negative where the bottom row comes first in memory. */
ptrdiff_t gscl_image_stride(const gscl_image *image);
/* Where row y begins. */
unsigned char *gscl_image_row(const gscl_image *image, uint32_t y);
/* `count` of its rows, from row y on, as an image. */
gscl_image gscl_image_rows(const gscl_image *image, uint32_t y, uint32_t count);
/* Whether rows, in the order of the stride, do not overlap. */
bool gscl_image_rows_fit(const gscl_image *image);

/* Channels of a layout, 1..4; 0 for AUTO and for what is none. */
uint32_t gscl_layout_channels(gscl_layout layout);
/* Whether blue comes first. */
static inline bool gscl_layout_is_bgr(gscl_layout layout) {
    return layout == GSCL_LAYOUT_BGR || layout == GSCL_LAYOUT_BGRA;
}
/* Whether the layout of an image is one of its channels, which are 1..4. */
bool gscl_image_has_layout(const gscl_image *image);

/* Pixels side by side, clamped to 0..1 and premultiplied.  Grey has three equal colours; without an alpha channel alpha
 * is 1. */
#define GSCL_MAX_READ 256u
typedef struct gscl_pixels {
    float colour[3][GSCL_MAX_READ], alpha[GSCL_MAX_READ];
} gscl_pixels;

/* Reads `count` pixels of row y, from x on; 1 to GSCL_MAX_READ, all within the row. */
void gscl_image_read(const gscl_image *image, uint32_t x, uint32_t y, size_t count, gscl_pixels *pixels);

/* The number of pixels that can be read at once from x on. */
static inline size_t gscl_image_read_count(const gscl_image *image, uint32_t x) {
    return image->width - x < GSCL_MAX_READ ? image->width - x : GSCL_MAX_READ;
}

#endif
