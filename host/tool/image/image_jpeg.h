/* What the image library does not tell about JPEG files. */
#ifndef GSCL_TOOL_IMAGE_JPEG_H
#define GSCL_TOOL_IMAGE_JPEG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Whether the bytes start as a JPEG file does. */
bool image_is_jpeg(const uint8_t *bytes, size_t size);

/* Whether a JPEG goes on to its end-of-image marker.  Decoders fill in grey for what is missing and say nothing. */
bool image_jpeg_is_complete(const uint8_t *bytes, size_t size);

#endif
