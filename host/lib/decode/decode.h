/* Decoding as a part of another public call. */
#ifndef GSCL_LIB_DECODE_H
#define GSCL_LIB_DECODE_H

#include <gscl/gscl.h>

/* What gscl_decode does between the beginning and the end of a public call. */
gscl_result gscl_decode_within(gscl_context *context, const uint8_t *bytes, size_t size,
                               const gscl_decode_settings *settings, gscl_image *image);

#endif
