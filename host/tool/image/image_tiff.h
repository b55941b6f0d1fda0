/* The metadata of TIFF files, which OpenImageIO reads only in part, and a writer. */
#ifndef GSCL_TOOL_IMAGE_TIFF_H
#define GSCL_TOOL_IMAGE_TIFF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cli/output_file.h"
#include "image/image_content.h"

/* Tags of TIFF. */
enum {
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
    TAG_SUBDIRECTORIES = 330,
    TAG_INK_SET = 332,
    TAG_EXTRA_SAMPLES = 338,
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

/* Whether the bytes start with the signature of a TIFF file, BigTIFF excluded. */
bool image_is_tiff(const uint8_t *bytes, size_t size);

/* Whether such a file has the marks of the raw formats of cameras, which derive from TIFF and need another reader. */
bool image_tiff_is_raw(const uint8_t *bytes, size_t size);

/* Whether a file has no number of bits per sample.  TIFF takes it for 1 bit, OpenImageIO for 8. */
bool image_tiff_lacks_bits(const uint8_t *bytes, size_t size);

/* Moves the metadata of a file into the content, and hides it from the reader of the pixels.  Also sets content->cmyk
 * and the orientation. */
void image_take_tiff_metadata(uint8_t *bytes, size_t size, image_content *content);

/* Writes an image of 1 to 4 channels, U8 or U16 samples, straight alpha and packed rows; `metadata` may be NULL, and its
 * code points are not written.  On failure returns false, and sets either output->error or the message. */
bool image_write_tiff(output_file *output, const gscl_image *image, const image_metadata *metadata,
                      char message[IMAGE_MESSAGE_SIZE]);

#endif
