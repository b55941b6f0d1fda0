/* A file's picture in both mappings against the second decoder. */
#ifndef STABILITY_DECODES_H
#define STABILITY_DECODES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <gscl/gscl.h>

/* No sample is more than 1/255 from what the second decoder draws (FORMAT.md, "Rendering"), in neither context; else false, and
 * `message` tells. */
bool decodes_alike(gscl_context *const contexts[2], const uint8_t *bytes, size_t size, char *message, size_t room);

#endif
