/* "File": header and checksum. */
#include "parts.h"

typedef struct {
    const uint8_t *bytes;
    size_t size, at;
    bool ended, malformed;
} cursor;

static uint32_t take_byte(cursor *from) {
    if (from->at >= from->size) {
        from->ended = true;
        return 0;
    }
    return from->bytes[from->at++];
}

static uint32_t take_varint(cursor *from) {
    uint32_t value = 0;
    for (uint32_t i = 0; i < 3; i++) {
        const uint32_t byte = take_byte(from);
        value |= (byte & 0x7F) << (7 * i);
        if (!(byte & 0x80)) {
            from->malformed |= i > 0 && byte == 0 && !from->ended;
            return value;
        }
    }
    from->malformed = true;
    return value;
}

static void read_flags(uint32_t flags, oracle_header *header) {
    header->blend = (oracle_blend)(flags & 3);
    header->codebook = flags >> 2 & 1;
    header->layout = flags >> 3 & 3;
    header->high_bit_depth = flags >> 5 & 1;
    header->has_chroma = flags >> 8 & 1;
    header->has_alpha = flags >> 9 & 1;
    header->has_opacity = flags >> 10 & 1;
    header->has_rotation = flags >> 11 & 1;
    header->has_anisotropy = flags >> 12 & 1;
    header->has_texture = flags >> 13 & 1;
    header->colours = header->has_chroma ? 3 : 1;
    header->channels = header->colours + (header->has_alpha ? 1 : 0);
}

static bool flags_allowed(uint32_t flags, const oracle_header *header) {
    const bool reserved = flags & 0xC0C0;
    return !reserved && (flags & 3) != 3 && (!header->has_chroma || header->layout >= 2) &&
           (!header->has_alpha || header->layout == 1 || header->layout == 3) &&
           (!header->has_rotation || header->has_anisotropy) && (!header->has_texture || !header->codebook);
}

oracle_result oracle_read_header(const uint8_t *bytes, size_t size, oracle_header *header, uint32_t *checksum) {
    if (size < 4 || bytes[0] != 0x67 || bytes[1] != 0x73 || bytes[2] != 0x63 || bytes[3] == 0)
        return ORACLE_NOT_GSCL;
    if (bytes[3] > 1)
        return ORACLE_NEWER_VERSION;

    cursor from = {bytes, size, 4, false, false};
    uint32_t flags = take_byte(&from);
    flags |= take_byte(&from) << 8;
    header->width = take_varint(&from) + 1;
    header->height = take_varint(&from) + 1;
    header->splats = take_varint(&from);
    *checksum = 0;
    for (int i = 0; i < 3; i++)
        *checksum = *checksum << 8 | take_byte(&from);
    header->bytes = from.at;

    if (from.ended)
        return ORACLE_TRUNCATED;
    read_flags(flags, header);
    if (from.malformed || !flags_allowed(flags, header) || header->width > 16384 || header->height > 16384 ||
        header->splats > 1048576)
        return ORACLE_CORRUPT;
    return ORACLE_OK;
}

static uint32_t crc24(uint32_t crc, const uint8_t *bytes, size_t size) {
    for (size_t i = 0; i < size; i++) {
        crc ^= (uint32_t)bytes[i] << 16;
        for (int bit = 0; bit < 8; bit++) {
            crc <<= 1;
            if (crc & 0x1000000)
                crc ^= 0x1864CFB;
        }
    }
    return crc;
}

uint32_t oracle_checksum(const uint8_t *bytes, size_t size, size_t header_bytes) {
    const uint32_t crc = crc24(0xB704CE, bytes, header_bytes - 3);
    return crc24(crc, bytes + header_bytes, size - header_bytes);
}
