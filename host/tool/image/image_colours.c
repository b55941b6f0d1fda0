#include "image/image_colours.h"

#include <stdio.h>

#include "colours/cicp.h"
#include "cli/message.h"
#include "image/colour_convert.h"
#include "image/colour_profile.h"
#include "image/exif.h"

static bool has_colours(const image_content *content) {
    const image_metadata *metadata = &content->metadata;
    return content->cmyk || content->damaged_profile || metadata->has_cicp || metadata->icc.size ||
           content->has_primaries || content->gamma > 0.0 || exif_names_adobe_rgb(&metadata->exif);
}

static void forget_colours(image_content *content) {
    image_blob_free(&content->metadata.icc);
    content->metadata.has_cicp = false;
    content->has_primaries = false;
    content->gamma = 0.0;
    exif_set_srgb(&content->metadata.exif);
}

/* Where the colours come from, for messages. */
static void name_colours(const image_content *content, const colour_profile *profile, char name[COLOUR_NAME_SIZE]) {
    if (content->metadata.has_cicp)
        snprintf(name, COLOUR_NAME_SIZE, "%s", cicp_name(content->metadata.cicp));
    else if (content->metadata.icc.size)
        colour_profile_name(profile, name);
    else if (content->has_primaries || content->gamma > 0.0)
        snprintf(name, COLOUR_NAME_SIZE, "the primaries and the gamma of the file");
    else
        snprintf(name, COLOUR_NAME_SIZE, "Adobe RGB, as its EXIF says,");
}

/* Takes the colours as sRGB, where that is possible, because nothing better is known. */
static bool take_as_srgb(const char *label, const image_read_options *options, image_content *content) {
    const bool has_profile = content->damaged_profile || content->metadata.icc.size;
    if (content->cmyk)
        return report_error(label, "holds CMYK colours %s; convert it to RGB first",
                            has_profile ? "and a colour profile that is damaged or not for CMYK"
                                        : "without a colour profile");
    forget_colours(content);
    if (!options->quiet)
        report_warning(label, "its colour profile is damaged or does not suit its pixels; it is taken as sRGB");
    return true;
}

/* Leaves the shortest description of the colours. */
static bool keep_colours(const char *label, const image_read_options *options, const colour_profile *profile,
                         image_content *content) {
    image_metadata *metadata = &content->metadata;
    char name[COLOUR_NAME_SIZE];
    name_colours(content, profile, name);
    metadata->has_cicp = metadata->has_cicp || colour_profile_find_cicp(profile, metadata->cicp);
    if (metadata->has_cicp)
        image_blob_free(&metadata->icc);
    else if (!metadata->icc.size && !colour_profile_save(profile, "as the encoded image", &metadata->icc))
        return report_error(label, "is too large for the available memory");
    if (options->verbose && metadata->has_cicp)
        report_note("%s: colours of %s kept as code points %d, %d", label, name, metadata->cicp[0], metadata->cicp[1]);
    else if (options->verbose)
        report_note("%s: colours of %s kept, with a profile of %zu bytes", label, name, metadata->icc.size);
    return true;
}

/* Whether the colours can be stored as they are.  Formats allow no profile of RGB for grey pixels. */
static bool can_keep(const colour_profile *profile, const image_content *content) {
    return profile->channels == (content->image.channels <= 2 ? 1 : 3) &&
           content->metadata.icc.size <= GSCL_MAX_BLOCK_SIZE;
}

static bool convert_colours(const char *label, const image_read_options *options, const colour_profile *profile,
                            image_content *content) {
    char name[COLOUR_NAME_SIZE];
    name_colours(content, profile, name);
    if (!colour_convert_to_srgb(profile, &content->image))
        return take_as_srgb(label, options, content);
    if (!options->quiet)
        report_note("%s: colours converted from %s to sRGB", label, name);
    content->cmyk = false;
    forget_colours(content);
    return true;
}

bool image_settle_colours(const char *label, const image_read_options *options, image_content *content) {
    const image_metadata *metadata = &content->metadata;
    colour_profile profile;
    if (!has_colours(content))
        return true;
    if (metadata->has_cicp && cicp_is_hdr(metadata->cicp))
        return options->keep_profile || report_error(label,
                                                     "holds HDR colours (%s), which cannot be converted to sRGB; "
                                                     "'gscl encode --keep-profile' stores them unchanged",
                                                     cicp_name(metadata->cicp));
    if (!colour_profile_open(&profile, content))
        return take_as_srgb(label, options, content);
    bool ok = true;
    if (colour_profile_is_srgb(&profile))
        forget_colours(content);
    else if (options->keep_profile && can_keep(&profile, content))
        ok = keep_colours(label, options, &profile, content);
    else
        ok = convert_colours(label, options, &profile, content);
    colour_profile_close(&profile);
    return ok;
}
