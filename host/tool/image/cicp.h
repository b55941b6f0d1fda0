/* Colour spaces by the code points of ITU-T H.273. */
#ifndef GSCL_TOOL_CICP_H
#define GSCL_TOOL_CICP_H

#include <stdbool.h>
#include <stdint.h>

#include <lcms2.h>

enum {
    CICP_PRIMARIES_SRGB = 1,
    CICP_UNSPECIFIED = 2,
    CICP_TRANSFER_SRGB = 13,
    CICP_TRANSFER_PQ = 16,
    CICP_TRANSFER_HLG = 18
};

/* x and y of white, red, green and blue.  Returns NULL for code points that are reserved. */
const double *cicp_primaries(uint8_t code);

/* The curve from samples to light, to be freed with cmsFreeToneCurve.  NULL without memory, and for code points that are
 * reserved or have no curve of one picture alone (PQ, HLG).  The curves of television are taken as that of sRGB, as
 * browsers do. */
cmsToneCurve *cicp_curve(cmsContext context, uint8_t code);

/* Whether the colours exceed the range of a display, and need a reader that maps them. */
bool cicp_is_hdr(const uint8_t cicp[2]);

/* A name for messages: "Display P3". */
const char *cicp_name(const uint8_t cicp[2]);

#endif
