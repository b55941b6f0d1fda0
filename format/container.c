#include "format/container.h"

#include <string.h>

#include "format/range_coder.h"

#define FIXED_SIZE 5u /* magic and version */
/* Zeros between the picture and blocks after it: a reader that does not know yet where the picture ends reads the bytes
 * that its decoder implies. */
#define GAP_SIZE GSF_IMPLIED_BYTES
#define LENGTH_SIZE 4u /* of the field before the check with the length of the blocks after the picture */

enum { VERSION_MASK = 0x0F, HAS_BLOCKS_BEFORE = 0x10, HAS_BLOCKS_AFTER = 0x20, RESERVED_FLAGS = 0xC0 };
/* Bits of a block's first byte. */
enum { LAST_BLOCK = 0x80, MANDATORY_BLOCK = 0x40, TYPE_MASK = 0x3F };

#define FIRST_TYPE_AFTER 32 /* smaller types belong before the picture */

static const uint8_t MAGIC[4] = {0xC7, 'g', 's', 'c'};
static const uint8_t TYPES[GSF_BLOCK_COUNT] = {
    [GSF_BLOCK_COLOUR_SPACE] = 0,
    [GSF_BLOCK_ICC] = 1,
    [GSF_BLOCK_EXIF] = 32,
    [GSF_BLOCK_XMP] = 33,
};

/* The remainder that each value of the top four bits contributes. */
static const uint16_t REMAINDERS[16] = {0x0000, 0x1021, 0x2042, 0x3063, 0x4084, 0x50A5, 0x60C6, 0x70E7,
                                        0x8108, 0x9129, 0xA14A, 0xB16B, 0xC18C, 0xD1AD, 0xE1CE, 0xF1EF};

uint16_t gsf_crc16(const uint8_t *bytes, size_t size) {
    uint16_t crc = 0xFFFF;
    for (size_t i = 0; i < size; i++) {
        crc = (uint16_t)(crc ^ bytes[i] << 8);
        crc = (uint16_t)(crc << 4 ^ REMAINDERS[crc >> 12]);
        crc = (uint16_t)(crc << 4 ^ REMAINDERS[crc >> 12]);
    }
    return crc ^ 0xFFFF;
}

void gsf_put_check(uint8_t *bytes, size_t size, uint16_t mask) {
    const uint16_t check = gsf_crc16(bytes, size) ^ mask;
    bytes[size] = (uint8_t)(check >> 8);
    bytes[size + 1] = (uint8_t)check;
}

bool gsf_has_check(const uint8_t *bytes, size_t size, uint16_t mask) {
    const uint8_t *check = bytes + size - GSF_CHECK_SIZE;
    return (gsf_crc16(bytes, size - GSF_CHECK_SIZE) ^ mask) == (check[0] << 8 | check[1]);
}

/* ---- Reading ---- */

/* A part of the file that is read from its start. */
typedef struct cursor {
    const uint8_t *at, *end;
} cursor;

static size_t bytes_left(const cursor *c) {
    return (size_t)(c->end - c->at);
}

/* At most three bytes, and no byte more than the value needs. */
static gsf_result get_varint(cursor *c, uint32_t *value) {
    *value = 0;
    for (unsigned i = 0; i < 3; i++) {
        if (bytes_left(c) == 0)
            return GSF_TRUNCATED;
        const uint8_t byte = *c->at++;
        *value |= (uint32_t)(byte & 0x7F) << (7 * i);
        if (byte < 0x80)
            return byte == 0 && i > 0 ? GSF_CORRUPT : GSF_OK;
    }
    return GSF_CORRUPT;
}

size_t gsf_get_varint(const uint8_t *bytes, size_t size, uint32_t *value) {
    cursor c = {bytes, bytes + size};
    return get_varint(&c, value) == GSF_OK ? (size_t)(c.at - bytes) : 0;
}

static gsf_result keep_block(gsf_container *container, unsigned type, bool mandatory, gsf_bytes content) {
    for (unsigned i = 0; i < GSF_BLOCK_COUNT; i++) {
        if (TYPES[i] != type)
            continue;
        container->blocks[i] = content;
        return i == GSF_BLOCK_COLOUR_SPACE && content.size != GSF_COLOUR_SPACE_SIZE ? GSF_CORRUPT : GSF_OK;
    }
    return mandatory ? GSF_UNKNOWN_BLOCK : GSF_OK;
}

/* Reads a list of blocks, whose types increase from `first_type` to at most `last_type`. */
static gsf_result get_blocks(cursor *c, unsigned first_type, unsigned last_type, gsf_container *container) {
    for (unsigned lowest = first_type;;) {
        uint32_t size;
        if (bytes_left(c) == 0)
            return GSF_TRUNCATED;
        const uint8_t start = *c->at++;
        const unsigned type = start & TYPE_MASK;
        if (type < lowest || type > last_type)
            return GSF_CORRUPT;
        gsf_result result = get_varint(c, &size);
        if (result != GSF_OK)
            return result;
        if (size > bytes_left(c))
            return GSF_TRUNCATED;
        result = keep_block(container, type, start & MANDATORY_BLOCK, (gsf_bytes){c->at, size});
        if (result != GSF_OK)
            return result;
        c->at += size;
        lowest = type + 1;
        if (start & LAST_BLOCK)
            return GSF_OK;
    }
}

/* Reads the blocks after the picture, whose length is the last field before the check, and ends the cursor where they
 * begin. */
static gsf_result get_blocks_after(cursor *c, gsf_container *container) {
    if (bytes_left(c) < LENGTH_SIZE)
        return GSF_TRUNCATED;
    const uint8_t *field = c->end - LENGTH_SIZE;
    const uint32_t size = field[0] | (uint32_t)field[1] << 8 | (uint32_t)field[2] << 16 | (uint32_t)field[3] << 24;
    if (bytes_left(c) < GAP_SIZE + LENGTH_SIZE || size > bytes_left(c) - LENGTH_SIZE - GAP_SIZE)
        return GSF_TRUNCATED;
    cursor blocks = {field - size, field};
    c->end = blocks.at - GAP_SIZE;
    for (unsigned i = 0; i < GAP_SIZE; i++)
        if (c->end[i] != 0)
            return GSF_CORRUPT;
    const gsf_result result = get_blocks(&blocks, FIRST_TYPE_AFTER, TYPE_MASK, container);
    return result == GSF_OK && bytes_left(&blocks) > 0 ? GSF_CORRUPT : result;
}

static gsf_result get_parts(cursor *c, uint8_t flags, gsf_container *container) {
    gsf_result result = flags & RESERVED_FLAGS ? GSF_CORRUPT : GSF_OK;
    if (result == GSF_OK && flags & HAS_BLOCKS_BEFORE)
        result = get_blocks(c, 0, FIRST_TYPE_AFTER - 1, container);
    if (result == GSF_OK && flags & HAS_BLOCKS_AFTER && container->is_intact)
        result = get_blocks_after(c, container);
    container->picture = (gsf_bytes){c->at, bytes_left(c)};
    return result;
}

static gsf_result check_magic(const uint8_t *bytes, size_t size) {
    if (size < sizeof MAGIC || memcmp(bytes, MAGIC, sizeof MAGIC) != 0)
        return GSF_NOT_GSCL;
    if (size > sizeof MAGIC && (bytes[4] & VERSION_MASK) != GSF_VERSION)
        return (bytes[4] & VERSION_MASK) > GSF_VERSION ? GSF_NEWER_VERSION : GSF_NOT_GSCL;
    return size < FIXED_SIZE + GSF_CHECK_SIZE ? GSF_TRUNCATED : GSF_OK;
}

gsf_result gsf_open_container(const uint8_t *bytes, size_t size, gsf_container *container) {
    *container = (gsf_container){.is_intact = false};
    const gsf_result magic = check_magic(bytes, size);
    if (magic != GSF_OK)
        return magic;
    container->is_intact = gsf_has_check(bytes, size, 0);
    cursor c = {bytes + FIXED_SIZE, bytes + size - GSF_CHECK_SIZE};
    const gsf_result result = get_parts(&c, bytes[4], container);
    if (result == GSF_OK)
        return GSF_OK;
    if (container->is_intact)
        return result == GSF_TRUNCATED ? GSF_CORRUPT : result;
    return result == GSF_TRUNCATED ? GSF_TRUNCATED : GSF_DAMAGED;
}

gsf_result gsf_open_container_prefix(const uint8_t *bytes, size_t size, gsf_container *container) {
    const gsf_result result = gsf_open_container(bytes, size, container);
    return container->is_intact || result != GSF_DAMAGED ? result : GSF_CORRUPT;
}

/* ---- Writing ---- */

size_t gsf_varint_size(size_t value) {
    return value < 1u << 7 ? 1 : value < 1u << 14 ? 2 : 3;
}

/* Size of the list of the blocks from `first` up to `end`; 0 without blocks. */
static size_t list_size(const gsf_bytes *blocks, unsigned first, unsigned end) {
    size_t size = 0;
    for (unsigned i = first; blocks && i < end; i++)
        size += blocks[i].data ? 1 + gsf_varint_size(blocks[i].size) + blocks[i].size : 0;
    return size;
}

static size_t before_size(const gsf_bytes *blocks) {
    return list_size(blocks, 0, GSF_BLOCK_EXIF);
}

static size_t after_size(const gsf_bytes *blocks) {
    return list_size(blocks, GSF_BLOCK_EXIF, GSF_BLOCK_COUNT);
}

size_t gsf_container_start_size(const gsf_bytes *blocks) {
    return FIXED_SIZE + before_size(blocks);
}

size_t gsf_container_end_size(const gsf_bytes *blocks) {
    const size_t after = after_size(blocks);
    return after + (after > 0 ? GAP_SIZE + LENGTH_SIZE : 0) + GSF_CHECK_SIZE;
}

size_t gsf_container_size(const gsf_bytes *blocks) {
    return gsf_container_start_size(blocks) + gsf_container_end_size(blocks);
}

bool gsf_blocks_are_valid(const gsf_bytes *blocks) {
    bool valid = true;
    for (unsigned i = 0; blocks && i < GSF_BLOCK_COUNT; i++)
        valid = valid && (!blocks[i].data || blocks[i].size <= GSF_MAX_BLOCK_SIZE);
    return valid && (!blocks || !blocks[GSF_BLOCK_COLOUR_SPACE].data ||
                     blocks[GSF_BLOCK_COLOUR_SPACE].size == GSF_COLOUR_SPACE_SIZE);
}

uint8_t *gsf_put_varint(uint8_t *at, size_t value) {
    for (; value >= 0x80; value >>= 7)
        *at++ = (uint8_t)(value | 0x80);
    *at++ = (uint8_t)value;
    return at;
}

static uint8_t *put_list(uint8_t *at, const gsf_bytes *blocks, unsigned first, unsigned end) {
    uint8_t *last = NULL;
    for (unsigned i = first; blocks && i < end; i++) {
        if (!blocks[i].data)
            continue;
        last = at;
        *at++ = TYPES[i];
        at = gsf_put_varint(at, blocks[i].size);
        memcpy(at, blocks[i].data, blocks[i].size);
        at += blocks[i].size;
    }
    if (last)
        *last |= LAST_BLOCK;
    return at;
}

void gsf_put_container_start(uint8_t *bytes, const gsf_bytes *blocks) {
    memcpy(bytes, MAGIC, sizeof MAGIC);
    bytes[4] = (uint8_t)(GSF_VERSION | (before_size(blocks) > 0 ? HAS_BLOCKS_BEFORE : 0) |
                         (after_size(blocks) > 0 ? HAS_BLOCKS_AFTER : 0));
    put_list(bytes + FIXED_SIZE, blocks, 0, GSF_BLOCK_EXIF);
}

void gsf_put_container_end(uint8_t *bytes, size_t size, const gsf_bytes *blocks) {
    const size_t after = after_size(blocks);
    uint8_t *at = bytes + size;
    for (unsigned i = 0; after > 0 && i < GAP_SIZE; i++)
        *at++ = 0;
    at = put_list(at, blocks, GSF_BLOCK_EXIF, GSF_BLOCK_COUNT);
    for (unsigned i = 0; after > 0 && i < LENGTH_SIZE; i++)
        *at++ = (uint8_t)(after >> (8 * i));
    gsf_put_check(bytes, (size_t)(at - bytes), 0);
}
