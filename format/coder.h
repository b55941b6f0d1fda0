/* One coder for both directions: the description of the payload is written once, in functions that
 * take a value and give it back when writing, and ignore the value and give the decoded one when
 * reading.  Counts the bits that each stream costs for those who want to know. */
#ifndef GSCL_FORMAT_CODER_H
#define GSCL_FORMAT_CODER_H

#include "format/range_coder.h"
#include "format/types.h"

typedef struct gsf_coder {
    bool decoding;
    gsf_range_encoder encoder;
    gsf_range_decoder decoder;
    gsf_stream stream;        /* whose bits are being counted */
    uint64_t *stream_bits256; /* GSF_STREAM_COUNT counters, or NULL */
} gsf_coder;

void gsf_coder_write_to(gsf_coder *coder, uint8_t *bytes, size_t capacity, uint64_t *stream_bits256);
void gsf_coder_read_from(gsf_coder *coder, const uint8_t *bytes, size_t size, uint64_t *stream_bits256);

/* True when reading on makes no sense: the input has run out. */
bool gsf_coder_starved(const gsf_coder *coder);

/* A value below `count`, symbol frequencies `freq[0..count)` that add up to `total`. */
uint32_t gsf_code_symbol(gsf_coder *coder, uint32_t value, const uint16_t *freq, uint32_t count, uint32_t total);
/* The same for two symbols, of which the one for 0 owns `first`. */
uint32_t gsf_code_either(gsf_coder *coder, uint32_t value, uint32_t first, uint32_t total);
/* A value below `count`, 1 <= count <= GSF_MAX_TOTAL, all equally likely. */
uint32_t gsf_code_uniform(gsf_coder *coder, uint32_t value, uint32_t count);
/* A value of `bits` bits, at most 16. */
uint32_t gsf_code_bits(gsf_coder *coder, uint32_t value, unsigned bits);

/* -log2(freq / total) in 1/256 bits. */
uint32_t gsf_cost256(uint32_t freq, uint32_t total);

#endif
