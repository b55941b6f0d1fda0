#include "image/orientation.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "image/image_samples.h"

/* The stored column and row of the pixel at (x, y) of the upright image.  The first stored row is the top (1, 2), the
 * bottom (3, 4), the left (5, 8) or the right (6, 7) of the upright image; the first stored column is its left (1, 4),
 * right (2, 3), top (5, 6) or bottom (7, 8). */
static void stored_place(const gscl_image *stored, int orientation, uint32_t x, uint32_t y, uint32_t *column,
                         uint32_t *row) {
    const uint32_t right = stored->width - 1, bottom = stored->height - 1;
    const uint32_t along_column = orientation >= 5 ? y : x, along_row = orientation >= 5 ? x : y;
    const int mirrored_columns = orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
    const int mirrored_rows = orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
    *column = mirrored_columns ? right - along_column : along_column;
    *row = mirrored_rows ? bottom - along_row : along_row;
}

bool orientation_apply(gscl_image *image, int orientation) {
    if (orientation <= 1 || orientation > 8)
        return true;
    const gscl_image stored = *image;
    const size_t pixel_bytes = stored.channels * image_sample_size(stored.sample);
    uint8_t *upright = malloc((size_t)stored.width * stored.height * pixel_bytes);
    if (!upright)
        return false;
    image->width = orientation >= 5 ? stored.height : stored.width;
    image->height = orientation >= 5 ? stored.width : stored.height;
    image->pixels = upright;
    for (uint32_t y = 0; y < image->height; y++) {
        for (uint32_t x = 0; x < image->width; x++, upright += pixel_bytes) {
            uint32_t column, row;
            stored_place(&stored, orientation, x, y, &column, &row);
            memcpy(upright, (uint8_t *)stored.pixels + ((size_t)row * stored.width + column) * pixel_bytes,
                   pixel_bytes);
        }
    }
    free(stored.pixels);
    return true;
}
