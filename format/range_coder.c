#include "format/range_coder.h"

#define TOP (UINT32_C(1) << 24) /* the range is kept at or above this between symbols */

/* The last symbol ends at the upper end of the interval, so that the remainder of the division is used too. */
static uint32_t narrowed(uint32_t range, uint32_t unit, uint32_t cum, uint32_t freq, uint32_t total) {
    return cum + freq == total ? range - cum * unit : freq * unit;
}

static void put_byte(gsf_range_encoder *encoder, uint8_t byte) {
    if (encoder->size < encoder->capacity)
        encoder->bytes[encoder->size] = byte;
    encoder->size++;
}

/* Moves the top byte of `low` out.  A carry can still change a byte, and it propagates through 0xFF bytes.  The last
 * byte that is not 0xFF and the run after it are therefore held back.  The first byte never gets a carry and is held
 * whatever its value. */
static void shift_low(gsf_range_encoder *encoder) {
    const uint8_t carry = (uint8_t)(encoder->low >> 32);
    const uint8_t top = (uint8_t)(encoder->low >> 24);
    if (carry != 0 || top != 0xFF || encoder->pending == 0) {
        if (encoder->pending > 0) {
            put_byte(encoder, (uint8_t)(encoder->held + carry));
            for (uint64_t i = 1; i < encoder->pending; i++)
                put_byte(encoder, (uint8_t)(0xFF + carry));
        }
        encoder->pending = 0;
        encoder->held = top;
    }
    encoder->pending++;
    encoder->low = (encoder->low & 0x00FFFFFF) << 8;
}

void gsf_range_encoder_init(gsf_range_encoder *encoder, uint8_t *bytes, size_t capacity) {
    *encoder = (gsf_range_encoder){.bytes = bytes, .capacity = capacity, .range = UINT32_MAX};
}

void gsf_range_encode(gsf_range_encoder *encoder, uint32_t cum, uint32_t freq, uint32_t total) {
    const uint32_t unit = encoder->range / total;
    encoder->low += (uint64_t)cum * unit;
    encoder->range = narrowed(encoder->range, unit, cum, freq, total);
    while (encoder->range < TOP) {
        encoder->range <<= 8;
        shift_low(encoder);
    }
}

/* One byte is always enough: the range is at least TOP, so that the interval holds a multiple of TOP, whose lower bytes
 * are the zeros that the decoder implies. */
void gsf_range_encoder_finish(gsf_range_encoder *encoder) {
    encoder->low = (encoder->low + TOP - 1) & ~(uint64_t)(TOP - 1);
    shift_low(encoder);
    encoder->low = 0;
    shift_low(encoder);
}

static uint8_t next_byte(gsf_range_decoder *decoder) {
    const uint8_t byte = decoder->position < decoder->size ? decoder->bytes[decoder->position] : 0;
    decoder->position++;
    return byte;
}

void gsf_range_decoder_init(gsf_range_decoder *decoder, const uint8_t *bytes, size_t size) {
    *decoder = (gsf_range_decoder){.bytes = bytes, .size = size, .range = UINT32_MAX};
    for (int i = 0; i < 4; i++)
        decoder->code = decoder->code << 8 | next_byte(decoder);
}

uint32_t gsf_range_decode_target(gsf_range_decoder *decoder, uint32_t total) {
    decoder->unit = decoder->range / total;
    const uint32_t target = decoder->code / decoder->unit;
    return target < total ? target : total - 1;
}

static void fill_range(gsf_range_decoder *decoder) {
    while (decoder->range < TOP) {
        decoder->range <<= 8;
        decoder->code = decoder->code << 8 | next_byte(decoder);
    }
}

void gsf_range_decode_consume(gsf_range_decoder *decoder, uint32_t cum, uint32_t freq, uint32_t total) {
    decoder->code -= cum * decoder->unit;
    decoder->range = narrowed(decoder->range, decoder->unit, cum, freq, total);
    fill_range(decoder);
}

bool gsf_range_decode_first(gsf_range_decoder *decoder, uint32_t first, uint32_t total) {
    const uint32_t bound = first * (decoder->range / total);
    const bool is_first = decoder->code < bound;
    const uint32_t mask = (uint32_t)is_first - 1; /* all ones for the second */
    decoder->range = is_first ? bound : decoder->range - bound;
    decoder->code -= bound & mask;
    fill_range(decoder);
    return is_first;
}

bool gsf_range_decoder_overrun(const gsf_range_decoder *decoder) {
    return decoder->position > decoder->size + GSF_IMPLIED_BYTES;
}
