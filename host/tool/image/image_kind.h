/* The image formats that gscl reads, recognised by their first bytes; the suffix of a file does not matter. */
#ifndef GSCL_TOOL_IMAGE_KIND_H
#define GSCL_TOOL_IMAGE_KIND_H

#include <stddef.h>
#include <stdint.h>

typedef enum image_kind {
    IMAGE_UNKNOWN,
    IMAGE_PNG,
    IMAGE_JPEG,
    IMAGE_WEBP,
    IMAGE_HEIF, /* AVIF and HEIC */
    IMAGE_JPEG2000,
    IMAGE_GIF,
    IMAGE_TIFF,
    IMAGE_EXR,
    IMAGE_HDR,
    IMAGE_BMP,
    IMAGE_ICO,
    IMAGE_TGA,
    IMAGE_PNM, /* PBM, PGM, PPM, PFM */
    IMAGE_PSD,
    IMAGE_SGI,
    IMAGE_DDS
} image_kind;

/* All formats, for messages. */
#define IMAGE_KIND_NAMES \
    "PNG, JPEG, WebP, AVIF, HEIC, JPEG 2000, GIF, TIFF, OpenEXR, HDR, BMP, ICO, TGA, PNM, PSD, SGI and DDS"

/* The format of a file.  TGA, which has no signature, is what has a possible header of it and no signature of others. */
image_kind image_kind_of(const uint8_t *bytes, size_t size);

/* The name of the plug-in of OpenImageIO that reads a format; NULL for formats with a reader of another library. */
const char *image_kind_plugin(image_kind kind);

/* The name of a frequent format that gscl does not read ("DPX"); NULL for what has no such signature. */
const char *image_foreign_name(const uint8_t *bytes, size_t size);

#endif
