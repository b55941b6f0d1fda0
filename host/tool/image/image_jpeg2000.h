/* Reads JPEG 2000 with OpenJPEG, because OpenImageIO ignores offsets, signs and kinds of alpha.  A part of the image module. */
#ifndef GSCL_TOOL_IMAGE_JPEG2000_H
#define GSCL_TOOL_IMAGE_JPEG2000_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "image/image_content.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Reads a file or a code stream: grey or RGB, with or without alpha; YCC becomes RGB.  Samples of up to 8 bits become U8,
 * others U16.  The caller frees the content in any case. */
bool image_read_jpeg2000(const uint8_t *bytes, size_t size, image_content *content, char message[IMAGE_MESSAGE_SIZE]);

#ifdef __cplusplus
}
#endif

#endif
