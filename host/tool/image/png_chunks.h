/* The chunks of PNG files that describe colours or hold metadata, with the checks that libpng lacks. */
#ifndef GSCL_TOOL_PNG_CHUNKS_H
#define GSCL_TOOL_PNG_CHUNKS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "image/image_content.h"

/* Names of these chunks, as png_set_keep_unknown_chunks takes them, and their number. */
extern const uint8_t png_metadata_chunks[];
#define PNG_METADATA_CHUNK_COUNT 6

/* Whether no chunk, up to the one that ends the image, is longer than what is left of the file. */
bool png_chunks_fit(const uint8_t *bytes, size_t size);

/* Copies what the chunks of a PNG file hold into the content. */
void png_take_metadata(const uint8_t *bytes, size_t size, image_content *content);

#endif
