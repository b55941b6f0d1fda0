/* The metadata of WebP files, which OpenImageIO reads without checks or not at all. */
#ifndef GSCL_TOOL_IMAGE_WEBP_H
#define GSCL_TOOL_IMAGE_WEBP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "image/image_content.h"

/* Moves the metadata of a file into the content, and hides it from the reader of the pixels. */
void image_take_webp_metadata(uint8_t *bytes, size_t size, image_content *content);

#endif
