/* The metadata of TIFF files, which OpenImageIO reads only in part. */
#ifndef GSCL_TOOL_IMAGE_TIFF_H
#define GSCL_TOOL_IMAGE_TIFF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "image/image_content.h"

/* Whether the bytes start with the signature of a TIFF file, BigTIFF excluded. */
bool image_is_tiff(const uint8_t *bytes, size_t size);

/* Moves the metadata of a file into the content, and hides it from the reader of the pixels.  Also sets content->cmyk
 * and the orientation. */
void image_take_tiff_metadata(uint8_t *bytes, size_t size, image_content *content);

#endif
