/* One coder for both directions, so that each part of the payload is described by one function.  When writing, a
 * function codes the value that it is given and returns it.  When reading, it ignores that value and returns the
 * decoded one.  The coder counts the bits of each stream on request. */
#ifndef GSCL_FORMAT_CODER_H
#define GSCL_FORMAT_CODER_H

#include "format/range_coder.h"
#include "format/types.h"

typedef struct gsf_coder {
    bool decoding;
    gsf_range_encoder encoder;
    gsf_range_decoder decoder;
    gsf_stream stream;        /* the stream whose bits are counted now */
    uint64_t *stream_bits256; /* GSF_STREAM_COUNT counters, or NULL */
} gsf_coder;

/* GSF_DECODING: whether the coder reads.  GSF_STREAM_BITS: where it counts bits, or NULL.  A program that only reads and
 * must be small defines GSF_SMALL_READER: it has no code that writes or counts bits, and takes the general way where
 * there is also a quicker one (GSF_IS_SMALL). */
#ifdef GSF_SMALL_READER
#define GSF_IS_SMALL true
#define GSF_DECODING(coder) ((void)(coder), true)
#define GSF_STREAM_BITS(owner) ((void)(owner), (uint64_t *)NULL)
#else
#define GSF_IS_SMALL false
#define GSF_DECODING(coder) ((coder)->decoding)
#define GSF_STREAM_BITS(owner) ((owner)->stream_bits256)
#endif

/* The bits from here on are those of the stream. */
static inline void gsf_coder_count_in(gsf_coder *coder, gsf_stream stream) {
    if (!GSF_IS_SMALL)
        coder->stream = stream;
}

void gsf_coder_write_to(gsf_coder *coder, uint8_t *bytes, size_t capacity, uint64_t *stream_bits256);
void gsf_coder_read_from(gsf_coder *coder, const uint8_t *bytes, size_t size, uint64_t *stream_bits256);

/* Whether the input has run out, so that decoding can stop.  Always false when writing. */
bool gsf_coder_overrun(const gsf_coder *coder);
/* Whether what has been coded so far does not depend on bytes after the end of the input.  Always true when writing. */
bool gsf_coder_is_certain(const gsf_coder *coder);

/* Codes a value below `count` with the frequencies freq[0..count), which add up to `total`. */
uint32_t gsf_code_symbol(gsf_coder *coder, uint32_t value, const uint16_t *freq, uint32_t count, uint32_t total);
/* Codes 0 or 1; the frequency of 0 is `first` of `total`. */
uint32_t gsf_code_binary(gsf_coder *coder, uint32_t value, uint32_t first, uint32_t total);
/* Codes a value below `count`, 1 <= count <= GSF_MAX_TOTAL, with equal frequencies. */
uint32_t gsf_code_uniform(gsf_coder *coder, uint32_t value, uint32_t count);
/* Codes a value of `bits` bits, at most 16, with equal frequencies. */
uint32_t gsf_code_bits(gsf_coder *coder, uint32_t value, unsigned bits);

/* -log2(freq / total) in 1/256 bits. */
uint32_t gsf_cost256(uint32_t freq, uint32_t total);

#endif
