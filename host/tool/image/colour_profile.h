/* Colour profiles, by LittleCMS. */
#ifndef GSCL_TOOL_COLOUR_PROFILE_H
#define GSCL_TOOL_COLOUR_PROFILE_H

#include <stdbool.h>

#include <lcms2.h>

#include "image/image_content.h"

#define COLOUR_NAME_SIZE 128 /* bytes of the name of a profile */

/* An open profile.  Zero is none. */
typedef struct colour_profile {
    cmsContext context;
    cmsHPROFILE handle;
    unsigned channels; /* of its colours: 1 grey, 3 RGB, 4 CMYK */
} colour_profile;

/* Opens what a content says about its colours: code points, profile, Adobe RGB by EXIF, or primaries and gamma.  Colours
 * that it says nothing about are those of sRGB.  Returns false if that is damaged or does not apply to such pixels. */
bool colour_profile_open(colour_profile *profile, const image_content *content);
/* Opens code points (primaries, transfer characteristics).  Returns false for those that no profile can express. */
bool colour_profile_open_cicp(colour_profile *profile, const uint8_t cicp[2], unsigned channels);
/* Opens sRGB, grey (1 channel) or RGB. */
bool colour_profile_open_srgb(colour_profile *profile, unsigned channels);
/* Opens the bytes of a profile.  Returns false if they are damaged or do not apply to `channels` colours, inks if 4. */
bool colour_profile_open_icc(colour_profile *profile, const image_blob *icc, unsigned channels);
void colour_profile_close(colour_profile *profile);

/* Copies the description that a profile holds. */
void colour_profile_name(const colour_profile *profile, char name[COLOUR_NAME_SIZE]);
/* Copies a profile that was made from code points or primaries as the bytes of a file, with a description.  Equal colours
 * give equal bytes.  Returns false without memory. */
bool colour_profile_save(const colour_profile *profile, const char *description, image_blob *icc);

/* Whether the colours are those of sRGB, within 2 of 255. */
bool colour_profile_is_srgb(const colour_profile *profile);
/* The code points of the same colours, within a quarter of 1 of 255.  Returns false when there are none. */
bool colour_profile_find_cicp(const colour_profile *profile, uint8_t cicp[2]);

/* A conversion between samples in 0..1 (inks: in 0..100) of two profiles, with relative colorimetric intent and black
 * point compensation; to be freed with cmsDeleteTransform.  Returns NULL if the profiles allow none. */
cmsHTRANSFORM colour_profile_conversion(const colour_profile *from, const colour_profile *to);

#endif
