/* What TIFF files say beside their samples, which OpenImageIO reads only in part, and a writer. */
#ifndef GSCL_TOOL_IMAGE_TIFF_H
#define GSCL_TOOL_IMAGE_TIFF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cli/output_file.h"
#include "image/image_content.h"

/* Tags of TIFF. */
enum {
    TAG_SUBFILE_TYPE = 254,
    TAG_WIDTH = 256,
    TAG_HEIGHT = 257,
    TAG_BITS = 258,
    TAG_COMPRESSION = 259,
    TAG_PHOTOMETRIC = 262,
    TAG_STRIP_OFFSETS = 273,
    TAG_ORIENTATION = 274,
    TAG_SAMPLES = 277,
    TAG_STRIP_ROWS = 278,
    TAG_STRIP_SIZES = 279,
    TAG_PREDICTOR = 317,
    TAG_COLOUR_MAP = 320,
    TAG_SUBDIRECTORIES = 330,
    TAG_INK_SET = 332,
    TAG_EXTRA_SAMPLES = 338,
    TAG_SAMPLE_FORMAT = 339,
    TAG_XMP = 700,
    TAG_IPTC = 33723,
    TAG_PHOTOSHOP = 34377,
    TAG_EXIF = 34665,
    TAG_ICC = 34675,
    TAG_GPS = 34853,
    TAG_LAYERS = 37724,
    TAG_INTEROPERABILITY = 40965,
    TAG_DNG_VERSION = 50706,
};

/* Moves the metadata of a TIFF or BigTIFF file into the content, and hides it from the reader of the pixels.  Also sets
 * content->cmyk, the orientation and content->white_is_zero, and changes the file so that the reader takes black for zero
 * and palettes for 16 bits.  Returns false with a message for files that OpenImageIO would not read as they say. */
bool image_prepare_tiff(uint8_t *bytes, size_t size, image_content *content, char message[IMAGE_MESSAGE_SIZE]);

/* Writes an image of 1 to 4 channels, U8 or U16 samples, straight alpha and packed rows; `metadata` may be NULL, and its
 * code points are not written.  On failure returns false, and sets either output->error or the message. */
bool image_write_tiff(output_file *output, const gscl_image *image, const image_metadata *metadata,
                      char message[IMAGE_MESSAGE_SIZE]);

#endif
