#define _DEFAULT_SOURCE /* strcasecmp */
#include "image/image_output.h"

#include <stdio.h>
#include <strings.h>

#include "colours/cicp.h"
#include "cli/message.h"
#include "image/colour_convert.h"
#include "image/colour_profile.h"
#include "image/exif.h"
#include "image/image_jpeg.h"

static bool is_jpeg(const image_format *format) {
    return strcasecmp(format->suffix, ".jpg") == 0 || strcasecmp(format->suffix, ".jpeg") == 0;
}

static bool is_png(const image_format *format) {
    return strcasecmp(format->suffix, ".png") == 0;
}

/* ---- Colours ----------------------------------------------------------------------------------- */

static void forget_colours(image_metadata *metadata) {
    image_blob_free(&metadata->icc);
    metadata->has_cicp = false;
}

/* Opens the colours of a file for an image of these channels.  A profile precedes code points. */
static bool open_colours(colour_profile *profile, const image_metadata *metadata, uint32_t channels) {
    const unsigned colours = channels <= 2 ? 1 : 3;
    if (!metadata->icc.size)
        return colour_profile_open_cicp(profile, metadata->cicp, colours);
    if (!colour_profile_open_icc(profile, &metadata->icc, colours))
        return false;
    if (profile->channels == colours)
        return true;
    colour_profile_close(profile); /* formats allow no profile of RGB for grey pixels */
    return false;
}

static bool convert_colours(const char *label, const image_format *format, bool on_background,
                            const colour_profile *profile, gscl_image *image, image_metadata *metadata) {
    char name[COLOUR_NAME_SIZE], reason[64];
    colour_profile_name(profile, name);
    snprintf(reason, sizeof reason, "%s %s", on_background ? "--background" : format->suffix,
             on_background ? "is a colour of sRGB" : "holds no colour profile");
    if (!colour_convert_to_srgb(profile, image))
        return report_error(label, "cannot be written: the colours of the file allow no conversion to sRGB, and %s; %s",
                            reason, on_background ? "leave it out" : "choose .png");
    report_note("%s: colours converted from %s to sRGB, because %s", label,
                metadata->icc.size ? name : cicp_name(metadata->cicp), reason);
    forget_colours(metadata);
    return true;
}

/* Leaves a profile, and in PNG the code points beside it, for readers that do not know them. */
static bool keep_colours(const char *label, const image_format *format, bool verbose, const colour_profile *profile,
                         image_metadata *metadata) {
    if (metadata->icc.size)
        metadata->has_cicp = false;
    else if (!colour_profile_save(profile, cicp_name(metadata->cicp), &metadata->icc))
        return report_error(label, "is too large for the available memory");
    if (is_jpeg(format) && metadata->icc.size > JPEG_MAX_ICC)
        return report_error(label, "cannot be written: the colour profile is too large for %s; choose .png",
                            format->suffix);
    if (verbose)
        report_note("%s: colour profile of %zu bytes written", label, metadata->icc.size);
    return true;
}

static bool report_hdr(const char *label, const image_format *format, bool on_background, const uint8_t cicp[2]) {
    if (on_background)
        return report_error(label,
                            "cannot be written: the file has HDR colours (%s), which cannot be drawn over a "
                            "--background of sRGB; leave it out",
                            cicp_name(cicp));
    return report_error(label, "cannot be written: the file has HDR colours (%s), which %s cannot hold; choose .png",
                        cicp_name(cicp), format->suffix);
}

/* Colours that no profile expresses: PNG has their code points. */
static bool settle_unknown(const char *label, const image_format *format, bool on_background,
                           image_metadata *metadata) {
    if (!metadata->icc.size && is_png(format) && !on_background)
        return true;
    if (!metadata->icc.size && cicp_is_hdr(metadata->cicp))
        return report_hdr(label, format, on_background, metadata->cicp);
    report_warning(label, "the colours of the file are of an unknown kind; they are taken as sRGB");
    forget_colours(metadata);
    return true;
}

static bool settle_colours(const char *label, const image_format *format, bool on_background, bool verbose,
                           gscl_image *image, image_metadata *metadata) {
    colour_profile profile;
    if (!metadata->icc.size && !metadata->has_cicp)
        return true;
    if (!open_colours(&profile, metadata, image->channels))
        return settle_unknown(label, format, on_background, metadata);
    bool ok = true;
    if (colour_profile_is_srgb(&profile))
        forget_colours(metadata);
    else if (format->metadata && !on_background)
        ok = keep_colours(label, format, verbose, &profile, metadata);
    else
        ok = convert_colours(label, format, on_background, &profile, image, metadata);
    colour_profile_close(&profile);
    return ok;
}

/* ---- Blocks ------------------------------------------------------------------------------------ */

static void settle_block(const char *label, const image_format *format, bool verbose, const char *name, size_t max_size,
                         image_blob *block) {
    if (block->size == 0)
        return;
    if (!format->metadata)
        report_note("%s: %s of %zu bytes left out, because %s holds none", label, name, block->size, format->suffix);
    else if (block->size > max_size)
        report_note("%s: %s of %zu bytes left out, because %s holds at most %zu", label, name, block->size,
                    format->suffix, max_size);
    else if (verbose)
        report_note("%s: %s of %zu bytes written", label, name, block->size);
    if (!format->metadata || block->size > max_size)
        image_blob_free(block);
}

bool image_prepare_output(const char *label, const image_format *format, bool on_background, bool verbose,
                          gscl_image *image, image_metadata *metadata) {
    if (metadata->exif.size && !exif_is_valid(&metadata->exif)) {
        report_warning(label, "the EXIF of the file is damaged; it is left out");
        image_blob_free(&metadata->exif);
    }
    if (!settle_colours(label, format, on_background, verbose, image, metadata))
        return false;
    settle_block(label, format, verbose, "EXIF", is_jpeg(format) ? JPEG_MAX_EXIF : IMAGE_MAX_BLOB, &metadata->exif);
    settle_block(label, format, verbose, "XMP", is_jpeg(format) ? JPEG_MAX_XMP : IMAGE_MAX_BLOB, &metadata->xmp);
    return true;
}
