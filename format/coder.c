#include "format/coder.h"

#include <limits.h>

/* 256 * log2(1 + i / 256).  It serves the bit counts only; decoding does not depend on it. */
static const uint16_t LOG2[257] = {
    0,   1,   3,   4,   6,   7,   9,   10,  11,  13,  14,  16,  17,  18,  20,  21,  22,  24,  25,  26,  28,  29,
    30,  32,  33,  34,  36,  37,  38,  40,  41,  42,  44,  45,  46,  47,  49,  50,  51,  52,  54,  55,  56,  57,
    59,  60,  61,  62,  63,  65,  66,  67,  68,  69,  71,  72,  73,  74,  75,  77,  78,  79,  80,  81,  82,  84,
    85,  86,  87,  88,  89,  90,  92,  93,  94,  95,  96,  97,  98,  99,  100, 102, 103, 104, 105, 106, 107, 108,
    109, 110, 111, 112, 113, 114, 116, 117, 118, 119, 120, 121, 122, 123, 124, 125, 126, 127, 128, 129, 130, 131,
    132, 133, 134, 135, 136, 137, 138, 139, 140, 141, 142, 143, 144, 145, 146, 147, 148, 149, 150, 151, 152, 153,
    154, 155, 155, 156, 157, 158, 159, 160, 161, 162, 163, 164, 165, 166, 167, 168, 169, 169, 170, 171, 172, 173,
    174, 175, 176, 177, 178, 178, 179, 180, 181, 182, 183, 184, 185, 185, 186, 187, 188, 189, 190, 191, 192, 192,
    193, 194, 195, 196, 197, 198, 198, 199, 200, 201, 202, 203, 203, 204, 205, 206, 207, 208, 208, 209, 210, 211,
    212, 212, 213, 214, 215, 216, 216, 217, 218, 219, 220, 220, 221, 222, 223, 224, 224, 225, 226, 227, 228, 228,
    229, 230, 231, 231, 232, 233, 234, 234, 235, 236, 237, 238, 238, 239, 240, 241, 241, 242, 243, 244, 244, 245,
    246, 247, 247, 248, 249, 249, 250, 251, 252, 252, 253, 254, 255, 255, 256,
};

/* The index of the highest bit that is set; value > 0. */
static unsigned highest_bit(uint32_t value) {
#if defined(__GNUC__)
    return (unsigned)(sizeof(unsigned) * CHAR_BIT - 1) - (unsigned)__builtin_clz(value);
#else
    unsigned index = 0;
    while (value >> (index + 1) != 0)
        index++;
    return index;
#endif
}

static uint32_t log2_256(uint32_t value) {
    const unsigned exponent = highest_bit(value);
    const uint32_t mantissa = exponent >= 8 ? value >> (exponent - 8) : value << (8 - exponent);
    return exponent * 256 + LOG2[mantissa - 256];
}

uint32_t gsf_cost256(uint32_t freq, uint32_t total) {
    return log2_256(total) - log2_256(freq);
}

void gsf_coder_write_to(gsf_coder *coder, uint8_t *bytes, size_t capacity, uint64_t *stream_bits256) {
    *coder = (gsf_coder){.decoding = false, .stream_bits256 = stream_bits256};
    gsf_range_encoder_init(&coder->encoder, bytes, capacity);
}

void gsf_coder_read_from(gsf_coder *coder, const uint8_t *bytes, size_t size, uint64_t *stream_bits256) {
    *coder = (gsf_coder){.decoding = true, .stream_bits256 = stream_bits256};
    gsf_range_decoder_init(&coder->decoder, bytes, size);
}

bool gsf_coder_overrun(const gsf_coder *coder) {
    return GSF_DECODING(coder) && gsf_range_decoder_overrun(&coder->decoder);
}

bool gsf_coder_is_certain(const gsf_coder *coder) {
    return !GSF_DECODING(coder) || coder->decoder.position <= coder->decoder.size;
}

static void count_bits(gsf_coder *coder, uint32_t freq, uint32_t total) {
    if (GSF_STREAM_BITS(coder))
        GSF_STREAM_BITS(coder)[coder->stream] += gsf_cost256(freq, total);
}

static void code_interval(gsf_coder *coder, uint32_t cum, uint32_t freq, uint32_t total) {
    if (GSF_DECODING(coder))
        gsf_range_decode_consume(&coder->decoder, cum, freq, total);
    else
        gsf_range_encode(&coder->encoder, cum, freq, total);
    count_bits(coder, freq, total);
}

#define STRIDE 8 /* symbols */

/* The symbol whose interval contains `target`; *cum is the start of the interval. */
static uint32_t find_symbol(const uint16_t *freq, uint32_t count, uint32_t target, uint32_t *cum) {
    uint32_t value = 0;
    *cum = 0;
    while (!GSF_IS_SMALL && value + STRIDE < count) { /* whole strides, which compilers sum with SIMD instructions */
        uint32_t sum = 0;
        for (uint32_t i = 0; i < STRIDE; i++)
            sum += freq[value + i];
        if (*cum + sum > target)
            break;
        *cum += sum;
        value += STRIDE;
    }
    /* Within a stride a branch on the symbol would be mispredicted. */
    uint32_t end = *cum;
    const uint32_t first = value;
    const uint32_t last = GSF_IS_SMALL || count - value <= STRIDE ? count - value - 1 : STRIDE - 1;
    for (uint32_t i = 0; i < last; i++) {
        end += freq[first + i];
        const bool beyond = end <= target;
        value += beyond;
        *cum = beyond ? end : *cum;
    }
    return value;
}

uint32_t gsf_code_symbol(gsf_coder *coder, uint32_t value, const uint16_t *freq, uint32_t count, uint32_t total) {
    uint32_t cum = 0;
    if (GSF_DECODING(coder)) {
        const uint32_t target = gsf_range_decode_target(&coder->decoder, total);
        value = find_symbol(freq, count, target, &cum);
    } else {
        for (uint32_t i = 0; i < value; i++)
            cum += freq[i];
    }
    code_interval(coder, cum, freq[value], total);
    return value;
}

uint32_t gsf_code_binary(gsf_coder *coder, uint32_t value, uint32_t first, uint32_t total) {
    if (GSF_DECODING(coder))
        value = !gsf_range_decode_first(&coder->decoder, first, total);
    else
        gsf_range_encode(&coder->encoder, value ? first : 0, value ? total - first : first, total);
    /* Avoids a branch on the value, which would be mispredicted, when no bits are counted. */
    if (GSF_STREAM_BITS(coder))
        count_bits(coder, value ? total - first : first, total);
    return value;
}

uint32_t gsf_code_uniform(gsf_coder *coder, uint32_t value, uint32_t count) {
    if (GSF_DECODING(coder))
        value = gsf_range_decode_target(&coder->decoder, count);
    code_interval(coder, value, 1, count);
    return value;
}

uint32_t gsf_code_bits(gsf_coder *coder, uint32_t value, unsigned bits) {
    return gsf_code_uniform(coder, value, UINT32_C(1) << bits);
}
