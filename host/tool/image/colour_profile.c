#include "image/colour_profile.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "colours/cicp.h"
#include "image/exif.h"

/* Floating point throughout: LittleCMS then neither rounds nor clips between the steps of a conversion. */
#define CONVERSION_FLAGS (cmsFLAGS_NOOPTIMIZE | cmsFLAGS_NOCACHE | cmsFLAGS_BLACKPOINTCOMPENSATION)

#define SAME_AS_SRGB \
    (2.0f / 255)                        /* largest difference of a sample between profiles that are taken as equal; real
                                           profiles of sRGB differ by up to 1.5 of 255 at the edge of the gamut */
#define SAME_AS_CICP (1.0f / (4 * 255)) /* smaller, because these colours are kept exactly where there are none */
#define PROBE_STEPS 9                   /* colours of each channel that are compared */
#define PROBE_GREYS 256

/* The date of creation in the header of a profile: year, month, day, hour, minute, second of 2 bytes each. */
#define DATE_OFFSET 24
#define DATE_SIZE 12

static const double adobe_rgb_primaries[8] = {0.3127, 0.3290, 0.64, 0.33, 0.21, 0.71, 0.15, 0.06};
#define ADOBE_RGB_GAMMA (563.0 / 256.0)

/* ---- Opening ----------------------------------------------------------------------------------- */

/* Takes a profile that was made.  Returns false if there is none. */
static bool take_made(colour_profile *profile, cmsHPROFILE made, unsigned channels) {
    profile->handle = made;
    profile->channels = channels;
    return made != NULL;
}

/* Whether primaries span a triangle with the white point in it, so that they have a matrix. */
static bool primaries_are_valid(const double *xy) {
    double sides[3];
    for (int i = 0; i < 3; i++) {
        const double *a = xy + 2 + 2 * i, *b = xy + 2 + 2 * ((i + 1) % 3);
        sides[i] = (b[0] - a[0]) * (xy[1] - a[1]) - (b[1] - a[1]) * (xy[0] - a[0]);
    }
    for (int i = 0; i < 8; i++) {
        if (!(fabs(xy[i]) < 2.0))
            return false;
    }
    const double least = 1e-4;
    return xy[1] > least && ((sides[0] > least && sides[1] > least && sides[2] > least) ||
                             (sides[0] < -least && sides[1] < -least && sides[2] < -least));
}

static bool start(colour_profile *profile) {
    *profile = (colour_profile){.context = cmsCreateContext(NULL, NULL)};
    return profile->context != NULL;
}

/* Closes the profile when opening it failed. */
static bool finish(colour_profile *profile, bool ok) {
    if (!ok)
        colour_profile_close(profile);
    return ok;
}

bool colour_profile_open_cicp(colour_profile *profile, const uint8_t cicp[2], unsigned channels) {
    return start(profile) &&
           finish(profile, take_made(profile, profile_of_cicp(profile->context, cicp, channels), channels));
}

/* Primaries and exponent; NULL and 0 stand for those of sRGB. */
static bool open_primaries(colour_profile *profile, const double *xy, double gamma, unsigned channels) {
    if (!start(profile))
        return false;
    cmsToneCurve *curve =
        gamma > 0.0 ? cmsBuildGamma(profile->context, gamma) : cicp_curve(profile->context, CICP_TRANSFER_SRGB);
    xy = xy ? xy : cicp_primaries(CICP_PRIMARIES_SRGB);
    return finish(profile, take_made(profile, profile_of_primaries(profile->context, xy, curve, channels), channels));
}

bool colour_profile_open_srgb(colour_profile *profile, unsigned channels) {
    return open_primaries(profile, NULL, 0.0, channels);
}

bool colour_profile_open_icc(colour_profile *profile, const image_blob *icc, unsigned channels) {
    if (!start(profile))
        return false;
    profile->handle = cmsOpenProfileFromMemTHR(profile->context, icc->bytes, (cmsUInt32Number)icc->size);
    if (!profile->handle)
        return finish(profile, false);
    const cmsColorSpaceSignature space = cmsGetColorSpace(profile->handle);
    profile->channels = space == cmsSigGrayData ? 1 : space == cmsSigRgbData ? 3 : space == cmsSigCmykData ? 4 : 0;
    /* Pixels of one grey may have a profile of RGB: then all three samples are that grey. */
    return finish(profile, profile->channels == channels || (profile->channels == 3 && channels == 1));
}

bool colour_profile_open(colour_profile *profile, const image_content *content) {
    const image_metadata *metadata = &content->metadata;
    const unsigned channels = content->cmyk ? 4 : content->image.channels <= 2 ? 1 : 3;
    *profile = (colour_profile){0};
    if (content->damaged_profile)
        return false;
    if (metadata->has_cicp && !content->cmyk)
        return colour_profile_open_cicp(profile, metadata->cicp, channels);
    if (metadata->icc.size)
        return colour_profile_open_icc(profile, &metadata->icc, channels);
    if (content->cmyk || (content->has_primaries && !primaries_are_valid(content->primaries)))
        return false;
    if (content->has_primaries || content->gamma > 0.0)
        return open_primaries(profile, content->has_primaries ? content->primaries : NULL, content->gamma, channels);
    if (exif_names_adobe_rgb(&metadata->exif))
        return open_primaries(profile, adobe_rgb_primaries, ADOBE_RGB_GAMMA, channels);
    return colour_profile_open_srgb(profile, channels);
}

void colour_profile_close(colour_profile *profile) {
    if (profile->handle)
        cmsCloseProfile(profile->handle);
    if (profile->context)
        cmsDeleteContext(profile->context);
    *profile = (colour_profile){0};
}

/* ---- Facts ------------------------------------------------------------------------------------- */

void colour_profile_name(const colour_profile *profile, char name[COLOUR_NAME_SIZE]) {
    if (!cmsGetProfileInfoASCII(profile->handle, cmsInfoDescription, "en", "US", name, COLOUR_NAME_SIZE) || !*name)
        snprintf(name, COLOUR_NAME_SIZE, "a profile without a name");
    name[COLOUR_NAME_SIZE - 1] = '\0';
}

static bool describe(const colour_profile *profile, const char *description) {
    cmsMLU *text = cmsMLUalloc(profile->context, 1);
    const bool ok = text && cmsMLUsetASCII(text, "en", "US", description) &&
                    cmsWriteTag(profile->handle, cmsSigProfileDescriptionTag, text);
    cmsMLUfree(text);
    return ok;
}

bool colour_profile_save(const colour_profile *profile, const char *description, image_blob *icc) {
    static const uint8_t date[DATE_SIZE] = {2000 >> 8, 2000 & 255, 0, 1, 0, 1}; /* not that of now */
    cmsUInt32Number size = 0;
    image_blob_free(icc);
    if (!describe(profile, description) || !cmsSaveProfileToMem(profile->handle, NULL, &size) ||
        size < DATE_OFFSET + DATE_SIZE || size > IMAGE_MAX_BLOB)
        return false;
    uint8_t *bytes = malloc(size);
    const bool ok = bytes && cmsSaveProfileToMem(profile->handle, bytes, &size) && image_blob_set(icc, bytes, size);
    if (ok)
        memcpy(icc->bytes + DATE_OFFSET, date, DATE_SIZE);
    free(bytes);
    return ok;
}

static cmsUInt32Number format_of(unsigned channels) {
    return channels == 1 ? TYPE_GRAY_FLT : channels == 3 ? TYPE_RGB_FLT : TYPE_CMYK_FLT;
}

cmsHTRANSFORM colour_profile_conversion(const colour_profile *from, const colour_profile *to) {
    return cmsCreateTransformTHR(from->context, from->handle, format_of(from->channels), to->handle,
                                 format_of(to->channels), INTENT_RELATIVE_COLORIMETRIC, CONVERSION_FLAGS);
}

/* Writes colours over the whole range, and a grey ramp.  Returns their number. */
static unsigned fill_probe(float *colours) {
    float *at = colours;
    for (int i = 0; i < PROBE_STEPS * PROBE_STEPS * PROBE_STEPS; i++) {
        *at++ = (float)(i % PROBE_STEPS) / (PROBE_STEPS - 1);
        *at++ = (float)(i / PROBE_STEPS % PROBE_STEPS) / (PROBE_STEPS - 1);
        *at++ = (float)(i / PROBE_STEPS / PROBE_STEPS) / (PROBE_STEPS - 1);
    }
    for (int i = 0; i < PROBE_GREYS; i++) {
        for (int c = 0; c < 3; c++)
            *at++ = (float)i / (PROBE_GREYS - 1);
    }
    return (unsigned)(at - colours) / 3;
}

/* Whether samples mean the same colours in two profiles of the same channels: a conversion changes none by more than
 * `tolerance`. */
static bool same_colours(const colour_profile *from, const colour_profile *to, float tolerance) {
    enum { COUNT = 3 * (PROBE_STEPS * PROBE_STEPS * PROBE_STEPS + PROBE_GREYS) };
    float probe[COUNT], converted[COUNT];
    const cmsHTRANSFORM conversion = colour_profile_conversion(from, to);
    if (!conversion)
        return false;
    const unsigned samples = 3 * fill_probe(probe);
    cmsDoTransform(conversion, probe, converted, samples / from->channels);
    cmsDeleteTransform(conversion);
    for (unsigned i = 0; i < samples; i++) {
        if (!(fabsf(probe[i] - converted[i]) <= tolerance))
            return false;
    }
    return true;
}

bool colour_profile_is_srgb(const colour_profile *profile) {
    colour_profile srgb;
    if (profile->channels == 4 || !colour_profile_open_srgb(&srgb, profile->channels))
        return false;
    const bool same = same_colours(profile, &srgb, SAME_AS_SRGB);
    colour_profile_close(&srgb);
    return same;
}

static bool is_cicp(const colour_profile *profile, const uint8_t cicp[2]) {
    colour_profile candidate;
    if (!colour_profile_open_cicp(&candidate, cicp, profile->channels))
        return false;
    const bool same = same_colours(profile, &candidate, SAME_AS_CICP);
    colour_profile_close(&candidate);
    return same;
}

bool colour_profile_find_cicp(const colour_profile *profile, uint8_t cicp[2]) {
    static const uint8_t primaries[] = {1, 12, 9, 5, 6, 11}, curves[] = {CICP_TRANSFER_SRGB, 4, 8};
    if (profile->channels == 4)
        return false;
    for (size_t i = 0; i < sizeof primaries; i++) {
        for (size_t j = 0; j < sizeof curves; j++) {
            const uint8_t candidate[2] = {primaries[i], curves[j]};
            if (is_cicp(profile, candidate)) {
                memcpy(cicp, candidate, sizeof candidate);
                return true;
            }
        }
    }
    return false;
}
