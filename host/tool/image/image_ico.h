/* Reads Windows icons and cursors: folders of PNG files and bitmaps. */
#ifndef GSCL_TOOL_IMAGE_ICO_H
#define GSCL_TOOL_IMAGE_ICO_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "image/image_content.h"

/* The largest image of an icon: bytes of a PNG file, or of a BMP file that is made of the icon's bitmap. */
typedef struct ico_image {
    bool is_png;
    uint8_t *bytes; /* allocated with malloc */
    size_t size;
    uint32_t width, height; /* of a bitmap */
    const uint8_t
        *mask; /* of a bitmap: a bit a pixel, 1 where it is transparent, in rows of multiples of 4 bytes from the
                            bottom upwards; NULL: none */
} ico_image;

/* Finds the largest image, among equals that of most bits.  `bytes` must stay valid while the image is used. */
bool ico_find_image(const uint8_t *bytes, size_t size, ico_image *found, char message[IMAGE_MESSAGE_SIZE]);

/* Gives an image that was read from the bitmap the alpha of the mask, unless it has alpha of its own that is not 0
 * everywhere.  Returns false without memory, and for an image of another size or kind of samples. */
bool ico_apply_mask(const ico_image *icon, gscl_image *image);

#endif
