/* Colour spaces by the code points of ITU-T H.273, and their profiles.  For all that shows files or makes them: it uses
 * LittleCMS only. */
#ifndef GSCL_COLOURS_CICP_H
#define GSCL_COLOURS_CICP_H

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

/* A profile of primaries (for 3 channels) and a curve, which it frees; to be closed with cmsCloseProfile.  NULL without
 * memory or a curve. */
cmsHPROFILE profile_of_primaries(cmsContext context, const double xy[8], cmsToneCurve *curve, unsigned channels);
/* A profile of code points.  NULL for those that no profile can express. */
cmsHPROFILE profile_of_cicp(cmsContext context, const uint8_t cicp[2], unsigned channels);

/* Whether the colours exceed the range of a display, and need a reader that maps them. */
bool cicp_is_hdr(const uint8_t cicp[2]);

/* A name for messages: "Display P3". */
const char *cicp_name(const uint8_t cicp[2]);

#endif
