#include "image/image_jpeg.h"

/* Second bytes of markers; the first is 0xFF (ITU-T T.81, table B.1). */
enum { STUFFING = 0x00, TEM = 0x01, RST0 = 0xD0, RST7 = 0xD7, SOI = 0xD8, EOI = 0xD9, FILL = 0xFF };

bool image_is_jpeg(const uint8_t *bytes, size_t size) {
    return size >= 3 && bytes[0] == 0xFF && bytes[1] == SOI && bytes[2] == 0xFF;
}

/* Offset of the second byte of the next marker, or `size`.  Restart markers and stuffed bytes belong to the scan. */
static size_t find_marker(const uint8_t *bytes, size_t size, size_t at) {
    while (at + 1 < size) {
        const uint8_t code = bytes[at + 1];
        if (bytes[at] == 0xFF && code != STUFFING && code != FILL && !(code >= RST0 && code <= RST7))
            return at + 1;
        at++;
    }
    return size;
}

bool image_jpeg_is_complete(const uint8_t *bytes, size_t size) {
    size_t at = find_marker(bytes, size, 2);
    while (at < size && bytes[at] != EOI) {
        at++;
        if (bytes[at - 1] != TEM) { /* a segment with its length, which counts itself */
            if (size - at < 2)
                return false;
            const size_t length = (size_t)bytes[at] << 8 | bytes[at + 1];
            at = length < size - at ? at + length : size;
        }
        at = find_marker(bytes, size, at);
    }
    return at < size;
}
