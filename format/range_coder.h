/* A byte-wise range coder with 32-bit range and integer frequencies (FORMAT.md, "Range coder").
 *
 * Encoder and decoder narrow the same interval.  A symbol with `freq` of `total`, starting at `cum`, costs
 * -log2(freq / total) bits. */
#ifndef GSCL_FORMAT_RANGE_CODER_H
#define GSCL_FORMAT_RANGE_CODER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define GSF_MAX_TOTAL 65536u /* largest sum of frequencies */

/* Zero bytes that the decoder reads beyond a complete payload.  The encoder ends with one byte where the decoder holds
 * four. */
#define GSF_IMPLIED_BYTES 3u

typedef struct gsf_range_encoder {
    uint8_t *bytes;
    size_t capacity;
    size_t size;  /* bytes produced, even when they did not fit */
    uint64_t low; /* bit 32 is a carry into the pending bytes */
    uint32_t range;
    uint64_t pending; /* bytes held back: `held`, then 0xFF as often as needed */
    uint8_t held;
} gsf_range_encoder;

typedef struct gsf_range_decoder {
    const uint8_t *bytes;
    size_t size;
    size_t position; /* bytes consumed; more than `size` when zeros were implied */
    uint32_t code, range;
    uint32_t unit; /* the range divided by the current symbol's total */
} gsf_range_decoder;

void gsf_range_encoder_init(gsf_range_encoder *encoder, uint8_t *bytes, size_t capacity);
/* 0 < freq, cum + freq <= total <= GSF_MAX_TOTAL. */
void gsf_range_encode(gsf_range_encoder *encoder, uint32_t cum, uint32_t freq, uint32_t total);
/* Writes the pending bytes.  `size` is then the payload's size, also where it exceeds the capacity. */
void gsf_range_encoder_finish(gsf_range_encoder *encoder);

void gsf_range_decoder_init(gsf_range_decoder *decoder, const uint8_t *bytes, size_t size);
/* A number in 0..total-1, which lies in [cum, cum + freq) of the next symbol. */
uint32_t gsf_range_decode_target(gsf_range_decoder *decoder, uint32_t total);
/* Decodes and removes one of two symbols with the frequencies `first` and total - first, without a branch on the
 * result.  Returns true for the first. */
bool gsf_range_decode_first(gsf_range_decoder *decoder, uint32_t first, uint32_t total);
/* Removes the symbol that contains the target, with the same total. */
void gsf_range_decode_consume(gsf_range_decoder *decoder, uint32_t cum, uint32_t freq, uint32_t total);
/* Whether more zeros were read beyond the end than a complete payload implies. */
bool gsf_range_decoder_overrun(const gsf_range_decoder *decoder);

#endif
