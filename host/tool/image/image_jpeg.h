/* Reads JPEG from memory and writes it to an output, with libjpeg. */
#ifndef GSCL_TOOL_IMAGE_JPEG_H
#define GSCL_TOOL_IMAGE_JPEG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cli/output_file.h"
#include "image/image_content.h"

/* Longest blocks that a segment of a JPEG file holds, bytes. */
#define JPEG_MAX_EXIF (65533 - 6)
#define JPEG_MAX_XMP (65533 - 29)
#define JPEG_MAX_ICC ((size_t)255 * (65533 - 14))

/* Reads a JPEG: grey, RGB or CMYK.  The caller frees the content in any case. */
bool image_read_jpeg(const uint8_t *bytes, size_t size, image_content *content, char message[IMAGE_MESSAGE_SIZE]);

/* Writes an image of 1 or 3 channels, U8 samples and packed rows, with blocks of at most the lengths above; `metadata`
 * may be NULL, and its code points are not written.  On failure returns false, and sets either output->error or the
 * message. */
bool image_write_jpeg(output_file *output, const gscl_image *image, const image_metadata *metadata,
                      char message[IMAGE_MESSAGE_SIZE]);

#endif
