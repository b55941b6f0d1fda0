#include "format/header.h"

#include <string.h>

enum {
    FLAG_BLEND = 0,  /* 2 bits */
    FLAG_CODING = 2, /* 1 bit */
    FLAG_LAYOUT = 3, /* 2 bits */
    FLAG_HIGH_BIT_DEPTH = 5,
    FLAG_CHROMA = 8,
    FLAG_ALPHA = 9,
    FLAG_OPACITY = 10,
    FLAG_ROTATION = 11,
    FLAG_ANISOTROPY = 12,
    FLAG_TEXTURE = 13,
    RESERVED_FLAGS = 0xC0C0
};

static const uint8_t MAGIC[3] = {'g', 's', 'c'};

unsigned gsf_channel_count(const gsf_header *header) {
    return (header->has_chroma ? 3u : 1u) + (header->has_alpha ? 1u : 0u);
}

bool gsf_header_is_valid(const gsf_header *header) {
    const bool rgb = header->layout == GSF_RGB || header->layout == GSF_RGBA;
    const bool transparent = header->layout == GSF_GREY_ALPHA || header->layout == GSF_RGBA;
    return (unsigned)header->blend <= GSF_BLEND_SUM && (unsigned)header->coding <= GSF_CODING_CODEBOOK &&
           (unsigned)header->layout <= GSF_RGBA && (rgb || !header->has_chroma) &&
           (transparent || !header->has_alpha) && (header->has_anisotropy || !header->has_rotation) &&
           (header->coding == GSF_CODING_SCALAR || !header->has_texture) && header->width >= 1 &&
           header->width <= GSF_MAX_DIMENSION && header->height >= 1 && header->height <= GSF_MAX_DIMENSION &&
           header->splat_count <= GSF_MAX_SPLATS;
}

static unsigned pack_flags(const gsf_header *header) {
    return (unsigned)header->blend << FLAG_BLEND | (unsigned)header->coding << FLAG_CODING |
           (unsigned)header->layout << FLAG_LAYOUT | (unsigned)header->high_bit_depth << FLAG_HIGH_BIT_DEPTH |
           (unsigned)header->has_chroma << FLAG_CHROMA | (unsigned)header->has_alpha << FLAG_ALPHA |
           (unsigned)header->has_opacity << FLAG_OPACITY | (unsigned)header->has_rotation << FLAG_ROTATION |
           (unsigned)header->has_anisotropy << FLAG_ANISOTROPY | (unsigned)header->has_texture << FLAG_TEXTURE;
}

static void unpack_flags(unsigned flags, gsf_header *header) {
    header->blend = (gsf_blend)(flags >> FLAG_BLEND & 3);
    header->coding = (gsf_coding)(flags >> FLAG_CODING & 1);
    header->layout = (gsf_layout)(flags >> FLAG_LAYOUT & 3);
    header->high_bit_depth = flags >> FLAG_HIGH_BIT_DEPTH & 1;
    header->has_chroma = flags >> FLAG_CHROMA & 1;
    header->has_alpha = flags >> FLAG_ALPHA & 1;
    header->has_opacity = flags >> FLAG_OPACITY & 1;
    header->has_rotation = flags >> FLAG_ROTATION & 1;
    header->has_anisotropy = flags >> FLAG_ANISOTROPY & 1;
    header->has_texture = flags >> FLAG_TEXTURE & 1;
}

static size_t put_varint(uint8_t *bytes, uint32_t value) {
    size_t size = 0;
    for (; value >= 0x80; value >>= 7)
        bytes[size++] = (uint8_t)(value | 0x80);
    bytes[size++] = (uint8_t)value;
    return size;
}

/* At most three bytes, and no byte more than the value needs. */
static gsf_result get_varint(const uint8_t *bytes, size_t available, size_t *position, uint32_t *value) {
    *value = 0;
    for (unsigned i = 0; i < 3; i++) {
        if (*position >= available)
            return GSF_TRUNCATED;
        const uint8_t byte = bytes[(*position)++];
        *value |= (uint32_t)(byte & 0x7F) << (7 * i);
        if (byte < 0x80)
            return byte == 0 && i > 0 ? GSF_CORRUPT : GSF_OK;
    }
    return GSF_CORRUPT;
}

static gsf_result parse_fields(const uint8_t *bytes, size_t available, gsf_header *header, size_t *size) {
    if (available < 6)
        return GSF_TRUNCATED;
    const unsigned flags = bytes[4] | (unsigned)bytes[5] << 8;
    unpack_flags(flags, header);
    *size = 6;
    uint32_t *fields[3] = {&header->width, &header->height, &header->splat_count};
    for (int i = 0; i < 3; i++) {
        const gsf_result result = get_varint(bytes, available, size, fields[i]);
        if (result != GSF_OK)
            return result;
    }
    header->width++;
    header->height++;
    if ((flags & RESERVED_FLAGS) != 0 || !gsf_header_is_valid(header))
        return GSF_CORRUPT;
    *size += GSF_CHECKSUM_SIZE;
    return *size <= available ? GSF_OK : GSF_TRUNCATED;
}

gsf_result gsf_parse_header(const uint8_t *bytes, size_t available, gsf_header *header, size_t *size) {
    *header = (gsf_header){.version = 0};
    *size = 0;
    if (available < 4 || memcmp(bytes, MAGIC, sizeof MAGIC) != 0 || bytes[3] == 0)
        return GSF_NOT_GSCL;
    header->version = bytes[3];
    if (header->version > GSF_VERSION)
        return GSF_NEWER_VERSION;
    return parse_fields(bytes, available, header, size);
}

size_t gsf_put_header(const gsf_header *header, uint8_t *bytes) {
    const unsigned flags = pack_flags(header);
    memcpy(bytes, MAGIC, sizeof MAGIC);
    bytes[3] = GSF_VERSION;
    bytes[4] = (uint8_t)flags;
    bytes[5] = (uint8_t)(flags >> 8);
    size_t size = 6;
    size += put_varint(bytes + size, header->width - 1);
    size += put_varint(bytes + size, header->height - 1);
    size += put_varint(bytes + size, header->splat_count);
    memset(bytes + size, 0, GSF_CHECKSUM_SIZE);
    return size + GSF_CHECKSUM_SIZE;
}

void gsf_code_background(gsf_coder *coder, gsf_coded_image *image) {
    coder->stream = GSF_STREAM_SIDE;
    for (unsigned i = 0; i < gsf_channel_count(&image->header); i++)
        image->background[i] =
            (uint16_t)gsf_code_bits(coder, image->background[i], image->header.high_bit_depth ? 16 : 8);
}

static void code_step(gsf_coder *coder, uint8_t *step, bool used) {
    *step = used ? (uint8_t)gsf_code_bits(coder, *step, 4) : 0;
}

void gsf_code_steps(gsf_coder *coder, const gsf_header *header, gsf_steps *steps) {
    code_step(coder, &steps->scale, true);
    code_step(coder, &steps->position, true);
    code_step(coder, &steps->angle, header->has_rotation);
    code_step(coder, &steps->luma, true);
    code_step(coder, &steps->chroma, header->has_chroma);
    code_step(coder, &steps->alpha, header->has_alpha);
    code_step(coder, &steps->opacity, header->has_opacity);
}

static uint32_t crc24(uint32_t crc, const uint8_t *bytes, size_t size) {
    /* The remainder that each value of the top four bits contributes. */
    static const uint32_t remainder[16] = {0x000000, 0x864CFB, 0x8AD50D, 0x0C99F6, 0x93E6E1, 0x15AA1A,
                                           0x1933EC, 0x9F7F17, 0xA18139, 0x27CDC2, 0x2B5434, 0xAD18CF,
                                           0x3267D8, 0xB42B23, 0xB8B2D5, 0x3EFE2E};
    for (size_t i = 0; i < size; i++) {
        crc ^= (uint32_t)bytes[i] << 16;
        crc = (crc << 4 & 0xFFFFFF) ^ remainder[crc >> 20];
        crc = (crc << 4 & 0xFFFFFF) ^ remainder[crc >> 20];
    }
    return crc;
}

uint32_t gsf_file_checksum(const uint8_t *bytes, size_t size, size_t header_size) {
    const uint32_t crc = crc24(0xB704CE, bytes, header_size - GSF_CHECKSUM_SIZE);
    return crc24(crc, bytes + header_size, size - header_size);
}

uint32_t gsf_stored_checksum(const uint8_t *bytes, size_t header_size) {
    const uint8_t *stored = bytes + header_size - GSF_CHECKSUM_SIZE;
    return (uint32_t)stored[0] << 16 | (uint32_t)stored[1] << 8 | stored[2];
}

void gsf_store_checksum(uint8_t *bytes, size_t size, size_t header_size) {
    const uint32_t crc = gsf_file_checksum(bytes, size, header_size);
    uint8_t *stored = bytes + header_size - GSF_CHECKSUM_SIZE;
    stored[0] = (uint8_t)(crc >> 16);
    stored[1] = (uint8_t)(crc >> 8);
    stored[2] = (uint8_t)crc;
}
