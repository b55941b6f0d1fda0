/* The uncompressed start of the file (FORMAT.md, "Header"). */
#ifndef GSCL_FORMAT_HEADER_H
#define GSCL_FORMAT_HEADER_H

#include "format/coder.h"
#include "format/types.h"

/* Number of coded channels: 1 or 3 for colour, and 1 for alpha. */
unsigned gsf_channel_count(const gsf_header *header);

#define GSF_MAX_HEADER_SIZE 18u /* 4 + 2 + 3 varints of 3 bytes + checksum */
#define GSF_CHECKSUM_SIZE 3u

/* Reads and checks the header.  *size is its size with the checksum, and thus the offset of the payload. */
gsf_result gsf_parse_header(const uint8_t *bytes, size_t available, gsf_header *header, size_t *size);
/* Writes a valid header into GSF_MAX_HEADER_SIZE bytes, with a checksum of zeros; returns its size. */
size_t gsf_put_header(const gsf_header *header, uint8_t *bytes);
/* Whether all fields are within the limits that the reader checks. */
bool gsf_header_is_valid(const gsf_header *header);

/* Code the first parts of the payload: the background, and the steps of scalar coding. */
void gsf_code_background(gsf_coder *coder, gsf_coded_image *image);
void gsf_code_steps(gsf_coder *coder, const gsf_header *header, gsf_steps *steps);

/* CRC-24 (OpenPGP) of a file without the three bytes of the checksum. */
uint32_t gsf_file_checksum(const uint8_t *bytes, size_t size, size_t header_size);
uint32_t gsf_stored_checksum(const uint8_t *bytes, size_t header_size);
void gsf_store_checksum(uint8_t *bytes, size_t size, size_t header_size);

#endif
