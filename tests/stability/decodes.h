/* Decodes of a file in several contexts against the drawing in double precision. */
#ifndef STABILITY_DECODES_H
#define STABILITY_DECODES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <gscl/gscl.h>

/* Whether all samples in all contexts have the precision that FORMAT.md prescribes ("Precision").  Otherwise `message`
 * receives the fault. */
bool decodes_alike(gscl_context *const *contexts, int count, const uint8_t *bytes, size_t size, char *message,
                   size_t capacity);

#endif
