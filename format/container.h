/* What surrounds the picture in a file: magic, version, blocks and check (FORMAT.md, "File"). */
#ifndef GSCL_FORMAT_CONTAINER_H
#define GSCL_FORMAT_CONTAINER_H

#include "format/types.h"

/* The parts of a file; all point into it. */
typedef struct gsf_container {
    bool is_intact; /* the check matches.  Otherwise blocks after the picture are taken as a part of it */
    gsf_bytes picture;
    gsf_bytes blocks[GSF_BLOCK_COUNT]; /* data is NULL where the file has no such block */
} gsf_container;

/* Finds the parts of a file.  Does not look into the picture. */
gsf_result gsf_open_container(const uint8_t *bytes, size_t size, gsf_container *container);
/* The same for the first bytes of a file, of which more may follow.  Where the check does not match, the picture is all
 * that has come of it, less the last bytes, which may be the check. */
gsf_result gsf_open_container_prefix(const uint8_t *bytes, size_t size, gsf_container *container);

/* Bytes before and after the picture.  `blocks`: GSF_BLOCK_COUNT blocks, or NULL. */
size_t gsf_container_start_size(const gsf_bytes *blocks);
size_t gsf_container_end_size(const gsf_bytes *blocks);
/* Both. */
size_t gsf_container_size(const gsf_bytes *blocks);
/* Writes what is before the picture: gsf_container_start_size bytes. */
void gsf_put_container_start(uint8_t *bytes, const gsf_bytes *blocks);
/* Writes what is after the picture, which ends at bytes + size: gsf_container_end_size bytes. */
void gsf_put_container_end(uint8_t *bytes, size_t size, const gsf_bytes *blocks);

/* Whether the sizes of blocks are within their limits (writer). */
bool gsf_blocks_are_valid(const gsf_bytes *blocks);

/* Numbers of 7 bits a byte (FORMAT.md, "Blocks"), at most 2^21 - 1: the size of one; writes one, and returns the byte behind
 * it; reads one, and returns its size, 0 where it is not complete or not valid. */
size_t gsf_varint_size(size_t value);
uint8_t *gsf_put_varint(uint8_t *at, size_t value);
size_t gsf_get_varint(const uint8_t *bytes, size_t size, uint32_t *value);

/* The check of these bytes: CRC-16/GENIBUS. */
uint16_t gsf_crc16(const uint8_t *bytes, size_t size);

#define GSF_CHECK_SIZE 2u /* bytes, the most significant first */
/* What is added by XOR to the check of repair packets, so that nothing else is taken for one; that of all else is 0. */
#define GSF_REPAIR_MASK 0xFFFFu
/* Writes the check of bytes[0..size) behind them. */
void gsf_put_check(uint8_t *bytes, size_t size, uint16_t mask);
/* Whether the last of these bytes, at least GSF_CHECK_SIZE, are the check of those before them. */
bool gsf_has_check(const uint8_t *bytes, size_t size, uint16_t mask);

#endif
