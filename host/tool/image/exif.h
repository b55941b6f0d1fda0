/* Blocks of EXIF: the few values that depend on the pixels. */
#ifndef GSCL_TOOL_EXIF_H
#define GSCL_TOOL_EXIF_H

#include <stdbool.h>

#include "image/image_content.h"

/* Removes the prefix "Exif\0\0" that some formats store. */
void exif_trim(image_blob *exif);

/* Whether the block has a directory that can be read. */
bool exif_is_valid(const image_blob *exif);

/* How the pixels lie, 1 (upright) to 8; 0 if the block does not say. */
int exif_orientation(const image_blob *exif);
/* Whether the block says, as cameras do, that the colours are those of Adobe RGB (1998). */
bool exif_names_adobe_rgb(const image_blob *exif);

/* State that the pixels are upright, and that the colours are those of sRGB, where the block has these values. */
void exif_set_upright(image_blob *exif);
void exif_set_srgb(image_blob *exif);
/* Removes the thumbnail, which shows the image as it was before. */
void exif_drop_thumbnail(image_blob *exif);

/* States in a packet of XMP that the pixels are upright, where it has that value. */
void xmp_set_upright(image_blob *xmp);

#endif
