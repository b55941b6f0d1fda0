/* The colours and the metadata of HEIF files (HEIC, AVIF), which OpenImageIO does not read. */
#ifndef GSCL_TOOL_IMAGE_HEIF_H
#define GSCL_TOOL_IMAGE_HEIF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "image/image_content.h"

/* Copies what a file holds beside its pixels into the content.  The reader of the pixels turns them upright. */
void image_take_heif_metadata(const uint8_t *bytes, size_t size, image_content *content);

#endif
