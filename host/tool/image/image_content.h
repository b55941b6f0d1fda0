/* What an image file holds: pixels, what their colours mean, and metadata. */
#ifndef GSCL_TOOL_IMAGE_CONTENT_H
#define GSCL_TOOL_IMAGE_CONTENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <gscl/gscl.h>

#define IMAGE_MESSAGE_SIZE 512 /* bytes of an error message, a phrase that follows the name of the file */

/* Format of the message about an image outside the limits of the library; takes width and height as unsigned. */
#define IMAGE_SIZE_MESSAGE "is %u x %u pixels; 1 x 1 to 16384 x 16384 are possible"

#define IMAGE_MAX_BLOB ((size_t)16 << 20) /* bytes; a longer profile or block of metadata is taken as damaged */

/* Bytes allocated with malloc.  NULL when size is 0. */
typedef struct image_blob {
    uint8_t *bytes;
    size_t size;
} image_blob;

/* Data beside the pixels.  EXIF begins with the TIFF header ("II" or "MM").  XMP is the packet, UTF-8 text. */
typedef struct image_metadata {
    image_blob icc;  /* a colour profile */
    bool has_cicp;   /* colours as code points of ITU-T H.273; they precede the profile */
    uint8_t cicp[2]; /* colour primaries, transfer characteristics */
    image_blob exif, xmp;
} image_metadata;

/* What the last of an even number of samples is, where the header of the file says more than the reader of the pixels. */
typedef enum image_alpha {
    IMAGE_ALPHA_AS_READ, /* as the reader says */
    IMAGE_ALPHA_STRAIGHT,
    IMAGE_ALPHA_PREMULTIPLIED,
    IMAGE_ALPHA_REFUSED,        /* alpha, with which the reader computes wrong colours */
    IMAGE_ALPHA_UNUSED,         /* no alpha: a sample that means nothing */
    IMAGE_ALPHA_UNUSED_IF_CLEAR /* straight alpha, but a sample that means nothing if it is 0 everywhere */
} image_alpha;

/* The image, upright or not, on a curve of any kind.  A zero struct is empty. */
typedef struct image_content {
    gscl_image image; /* pixels allocated with malloc */
    bool cmyk;        /* whether the four channels are inks, 0 for none */
    image_alpha alpha;
    bool white_is_zero; /* whether the colours, read as if 0 was black, are still negative */
    int orientation;    /* as EXIF counts, 1..8, where the format has a field of its own; else 0 */
    image_metadata metadata;
    bool damaged_profile;            /* whether there is a colour profile that cannot be extracted */
    bool has_primaries;              /* without a profile; default: those of sRGB */
    double primaries[8];             /* x and y of white, red, green, blue */
    double gamma;                    /* without a profile: exponent from samples to light; 0: the curve of sRGB */
    size_t other_bytes;              /* of metadata that gscl does not store: comments, IPTC, text */
    bool has_more_images;            /* frames or pages beside the one that was read */
    uint64_t clamped;                /* F32 samples outside 0..1, which the encoder clamps */
    char damage[IMAGE_MESSAGE_SIZE]; /* a fault in spite of which the pixels were read, as a phrase; empty: none */
} image_content;

/* What to do with what a file holds beside its pixels.  The default, zero, drops it. */
typedef struct image_read_options {
    bool keep_profile;        /* leave the colours as they are; otherwise they are converted to sRGB */
    bool keep_exif, keep_xmp; /* return these blocks */
    bool quiet;               /* print neither warnings nor that colours were converted */
    bool verbose;             /* also print what was turned, kept and dropped */
} image_read_options;

#ifdef __cplusplus
extern "C" {
#endif

/* Replaces a blob by a copy of bytes.  Returns false without memory. */
bool image_blob_set(image_blob *blob, const void *bytes, size_t size);
/* Appends bytes.  Returns false without memory, or if the blob would be longer than IMAGE_MAX_BLOB. */
bool image_blob_append(image_blob *blob, const void *bytes, size_t size);
/* Releases a blob and empties it. */
void image_blob_free(image_blob *blob);

/* Releases what a struct holds and empties it. */
void image_metadata_free(image_metadata *metadata);
void image_content_free(image_content *content);

#ifdef __cplusplus
}
#endif

#endif
