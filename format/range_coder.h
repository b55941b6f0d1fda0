/* A byte-wise range coder with 32-bit range and integer frequencies (FORMAT.md, "Range coder").
 *
 * Encoder and decoder narrow the same interval; a symbol that owns `freq` of `total` starting at
 * `cum` costs -log2(freq / total) bits. */
#ifndef GSCL_FORMAT_RANGE_CODER_H
#define GSCL_FORMAT_RANGE_CODER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define GSF_MAX_TOTAL 65536u /* largest sum of frequencies */

/* Bytes that the decoder reads beyond a complete payload, as zeros: the encoder ends with one byte
 * where the decoder holds four. */
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
    uint32_t unit; /* of the range, for each of the current symbol's total */
} gsf_range_decoder;

void gsf_range_encoder_init(gsf_range_encoder *encoder, uint8_t *bytes, size_t capacity);
/* 0 < freq, cum + freq <= total <= GSF_MAX_TOTAL. */
void gsf_range_encode(gsf_range_encoder *encoder, uint32_t cum, uint32_t freq, uint32_t total);
/* Writes out what is pending.  `size` is then the payload's size; it did not fit if > capacity. */
void gsf_range_encoder_finish(gsf_range_encoder *encoder);

void gsf_range_decoder_init(gsf_range_decoder *decoder, const uint8_t *bytes, size_t size);
/* The number in 0..total-1 that the next symbol's [cum, cum + freq) contains. */
uint32_t gsf_range_decode_target(gsf_range_decoder *decoder, uint32_t total);
/* Decodes one of two symbols that own `first` and the rest of `total`; true: the first.  For both at once, without a
 * branch on which it is. */
bool gsf_range_decode_first(gsf_range_decoder *decoder, uint32_t first, uint32_t total);
/* Removes the symbol that was found with the target, of the same total. */
void gsf_range_decode_consume(gsf_range_decoder *decoder, uint32_t cum, uint32_t freq, uint32_t total);
/* More bytes were wanted than any complete payload lacks. */
bool gsf_range_decoder_starved(const gsf_range_decoder *decoder);

#endif
