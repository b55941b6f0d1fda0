/* "Range coder". */
#include "parts.h"

static uint32_t next_byte(oracle_decoder *decoder) {
    const size_t at = decoder->consumed++;
    return at < decoder->size ? decoder->bytes[at] : 0;
}

void oracle_decoder_start(oracle_decoder *decoder, const uint8_t *bytes, size_t size) {
    *decoder = (oracle_decoder){.bytes = bytes, .size = size, .range = 0xFFFFFFFFu};
    for (int i = 0; i < 4; i++)
        decoder->code = decoder->code << 8 | next_byte(decoder);
}

bool oracle_decoder_overrun(const oracle_decoder *decoder) {
    return decoder->consumed > decoder->size + 3;
}

bool oracle_decoder_failed(const oracle_decoder *decoder) {
    return decoder->corrupt || oracle_decoder_overrun(decoder);
}

static uint32_t target_of(const oracle_decoder *decoder, uint32_t total) {
    const uint32_t target = decoder->code / (decoder->range / total);
    return target < total - 1 ? target : total - 1;
}

static void narrow(oracle_decoder *decoder, uint32_t cum, uint32_t frequency, uint32_t total) {
    const uint32_t unit = decoder->range / total;
    decoder->code -= cum * unit;
    decoder->range = cum + frequency == total ? decoder->range - cum * unit : frequency * unit;
    while (decoder->range < 1u << 24) {
        decoder->range <<= 8;
        decoder->code = decoder->code << 8 | next_byte(decoder);
    }
}

uint32_t oracle_symbol(oracle_decoder *decoder, const uint32_t *frequencies, uint32_t count) {
    uint64_t total = 0;
    for (uint32_t i = 0; i < count; i++)
        total += frequencies[i];
    if (total < 1 || total > 65536) {
        decoder->corrupt = true;
        return 0;
    }
    const uint32_t target = target_of(decoder, (uint32_t)total);
    uint32_t symbol = 0, cum = 0;
    while (target >= cum + frequencies[symbol])
        cum += frequencies[symbol++];
    narrow(decoder, cum, frequencies[symbol], (uint32_t)total);
    return symbol;
}

uint32_t oracle_uniform(oracle_decoder *decoder, uint32_t n) {
    if (n < 1 || n > 65536) {
        decoder->corrupt = true;
        return 0;
    }
    if (n == 1)
        return 0;
    const uint32_t symbol = target_of(decoder, n);
    narrow(decoder, symbol, 1, n);
    return symbol;
}

uint32_t oracle_raw(oracle_decoder *decoder, uint32_t bits) {
    return oracle_uniform(decoder, 1u << bits);
}
