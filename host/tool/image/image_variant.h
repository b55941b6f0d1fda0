/* The variants of formats: what the header of a file says of its fourth sample and of its colours and OpenImageIO does not
 * pass on, and which variants OpenImageIO reads wrongly.  tests/formats compares all of them with other readers. */
#ifndef GSCL_TOOL_IMAGE_VARIANT_H
#define GSCL_TOOL_IMAGE_VARIANT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "image/image_content.h"
#include "image/image_kind.h"

/* Sets content->alpha and the colours that a header states.  Returns false with a message for a variant that would not be
 * read as the file says. */
bool image_check_variant(image_kind kind, const uint8_t *bytes, size_t size, image_content *content,
                         char message[IMAGE_MESSAGE_SIZE]);

#endif
