#include "image/image_webp.h"

#include <string.h>

#include "image/exif.h"

#define FILE_HEADER 12 /* "RIFF", size, "WEBP" */
#define CHUNK_HEADER 8

/* Flags of the first byte of the chunk VP8X. */
enum { FLAG_XMP = 0x04, FLAG_EXIF = 0x08, FLAG_ICC = 0x20 };

static size_t little_endian(const uint8_t *b) {
    return (size_t)b[0] | (size_t)b[1] << 8 | (size_t)b[2] << 16 | (size_t)b[3] << 24;
}

/* Takes a chunk that holds metadata.  Its new name is one that readers skip. */
static void take_chunk(uint8_t *chunk, size_t size, image_content *content) {
    image_metadata *metadata = &content->metadata;
    uint8_t *bytes = chunk + CHUNK_HEADER;
    if (memcmp(chunk, "VP8X", 4) == 0 && size > 0)
        bytes[0] &= (uint8_t) ~(FLAG_ICC | FLAG_EXIF | FLAG_XMP);
    else if (memcmp(chunk, "ICCP", 4) == 0)
        content->damaged_profile = size == 0 || !image_blob_set(&metadata->icc, bytes, size);
    else if (memcmp(chunk, "EXIF", 4) == 0)
        image_blob_set(&metadata->exif, bytes, size);
    else if (memcmp(chunk, "XMP ", 4) == 0)
        image_blob_set(&metadata->xmp, bytes, size);
    else
        return;
    if (memcmp(chunk, "VP8X", 4) != 0)
        memcpy(chunk, "none", 4);
}

void image_take_webp_metadata(uint8_t *bytes, size_t size, image_content *content) {
    size_t at = FILE_HEADER;
    while (size - at >= CHUNK_HEADER) {
        const size_t length = little_endian(bytes + at + 4), left = size - at - CHUNK_HEADER;
        if (length > left)
            break;
        take_chunk(bytes + at, length, content);
        at += CHUNK_HEADER + (length + length % 2 <= left ? length + length % 2 : left);
    }
    exif_trim(&content->metadata.exif);
}
