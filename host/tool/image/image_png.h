/* Reads PNG from memory and writes it to an output, with libpng. */
#ifndef GSCL_TOOL_IMAGE_PNG_H
#define GSCL_TOOL_IMAGE_PNG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cli/output_file.h"
#include "image/image_content.h"

/* Reads a PNG: grey or RGB with or without alpha, 8 or 16 bits; palettes and small depths become 8 bits.
 * The caller frees the content in any case. */
bool image_read_png(const uint8_t *bytes, size_t size, image_content *content, char message[IMAGE_MESSAGE_SIZE]);

/* Writes an image of U8 or U16 samples, straight alpha and packed rows; `metadata` may be NULL.  On failure returns
 * false, and sets either output->error or the message. */
bool image_write_png(output_file *output, const gscl_image *image, const image_metadata *metadata,
                     char message[IMAGE_MESSAGE_SIZE]);

#endif
