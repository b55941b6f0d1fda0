/* Checks of JPEG files that OpenImageIO lacks. */
#ifndef GSCL_TOOL_IMAGE_JPEG_H
#define GSCL_TOOL_IMAGE_JPEG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Whether the bytes start with the signature of a JPEG file. */
bool image_is_jpeg(const uint8_t *bytes, size_t size);

/* Whether a JPEG file has its end-of-image marker.  Decoders fill missing parts with grey and report no error. */
bool image_jpeg_is_complete(const uint8_t *bytes, size_t size);

#endif
