/* The range coder at its limits. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "format/range_coder.h"
#include "report.h"

/* Between symbols the range is at least 2^24, and a total at most 2^16: a symbol's share of the range is cut by less
 * than one part in 2^8 of it, log2(1 + 2^-8) bits; the end takes 4 bytes at most. */
#define LOST_BITS 0.00562
#define END_BITS 32.0

/* A symbol: the start and the width of its interval, and the total of all widths. */
typedef struct {
    uint32_t cum, freq, total;
} symbol;

typedef symbol (*symbol_maker)(uint32_t i, uint32_t *state);

static uint32_t next_random(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

/* ---- One stream ---- */

static void check_decoder(const uint8_t *bytes, size_t size, uint32_t count, symbol_maker make) {
    uint32_t state = 1;
    gsf_range_decoder decoder;
    gsf_range_decoder_init(&decoder, bytes, size);
    for (uint32_t i = 0; i < count; i++) {
        const symbol s = make(i, &state);
        const uint32_t target = gsf_range_decode_target(&decoder, s.total);
        if (target < s.cum || target - s.cum >= s.freq)
            fail_msg("symbol %u is not what was written", i);
        gsf_range_decode_consume(&decoder, s.cum, s.freq, s.total);
    }
    assert_int_equal(decoder.position, size + GSF_IMPLIED_BYTES);
}

static size_t encode_symbols(uint8_t *bytes, size_t capacity, uint32_t count, symbol_maker make, double *entropy) {
    uint32_t state = 1;
    gsf_range_encoder encoder;
    gsf_range_encoder_init(&encoder, bytes, capacity);
    *entropy = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        const symbol s = make(i, &state);
        gsf_range_encode(&encoder, s.cum, s.freq, s.total);
        *entropy += log2((double)s.total / s.freq);
    }
    gsf_range_encoder_finish(&encoder);
    assert_true(encoder.size <= capacity);
    return encoder.size;
}

static void check_stream(const char *name, uint32_t count, symbol_maker make) {
    const size_t capacity = (size_t)count * 3 + 64;
    uint8_t *bytes = malloc(capacity), *again = malloc(capacity);
    double entropy;
    assert_true(bytes && again);
    const size_t size = encode_symbols(bytes, capacity, count, make, &entropy);
    assert_int_equal(encode_symbols(again, capacity, count, make, &entropy), size);
    assert_memory_equal(bytes, again, size);
    check_decoder(bytes, size, count, make);
    const double bound = LOST_BITS * count + END_BITS, lost = 8.0 * (double)size - entropy;
    report("range coder", name, "", "bits beyond the entropy", bound, lost);
    if (lost > bound)
        fail_msg("%s: %g bits more than the entropy, at most %g expected", name, lost, bound);
    free(bytes);
    free(again);
}

/* ---- Streams ---- */

static symbol only_one(uint32_t i, uint32_t *state) {
    const uint32_t total = i % 3 == 0 ? 1 : i % 3 == 1 ? 65536 : 1 + next_random(state) % 65536;
    return (symbol){0, total, total};
}
static symbol rare_first(uint32_t i, uint32_t *state) {
    (void)i, (void)state;
    return (symbol){0, 1, 65536};
}
static symbol rare_last(uint32_t i, uint32_t *state) {
    (void)i, (void)state;
    return (symbol){65535, 1, 65536};
}
static symbol likely(uint32_t i, uint32_t *state) {
    (void)state;
    return i % 65536 == 65535 ? (symbol){65535, 1, 65536} : (symbol){0, 65535, 65536};
}
static symbol likely_last(uint32_t i, uint32_t *state) {
    (void)state;
    return i % 65536 == 65535 ? (symbol){0, 1, 65536} : (symbol){1, 65535, 65536};
}
/* Totals, frequencies and symbols of every size. */
static symbol any(uint32_t i, uint32_t *state) {
    (void)i;
    const uint32_t total = 1 + next_random(state) % (1u << (1 + next_random(state) % 16));
    const uint32_t freq = 1 + next_random(state) % total;
    return (symbol){next_random(state) % (total - freq + 1), freq, total};
}
static symbol first_half(uint32_t i, uint32_t *state) {
    (void)i, (void)state;
    return (symbol){0, 32768, 65536};
}

static void test_one_symbol_alphabets(void **state) {
    (void)state;
    check_stream("alphabets of one symbol, 100,000", 100000, only_one);
}

static void test_one_symbol(void **state) {
    (void)state;
    check_stream("one symbol of probability 1", 1, only_one);
    check_stream("one symbol, the first of 65536", 1, rare_first);
    check_stream("one symbol, the last of 65536", 1, rare_last);
    check_stream("one symbol of probability 1/2", 1, first_half);
    check_stream("no symbol", 0, any);
}

static void test_probability_limits(void **state) {
    (void)state;
    check_stream("probability 1/65536, the first, 100,000", 100000, rare_first);
    check_stream("probability 1/65536, the last, 100,000", 100000, rare_last);
    check_stream("probability 65535/65536, the first, 1,000,000", 1000000, likely);
    check_stream("probability 65535/65536, the last, 1,000,000", 1000000, likely_last);
}

static void test_ten_million_symbols(void **state) {
    (void)state;
    check_stream("any symbols, 10,000,000", 10000000, any);
}

/* ---- Carries ---- */

#define TOTAL 65536u

/* Encodes `run` symbols whose intervals all contain the point 1/2, so that no byte can be written, and then one on the
 * side given by `up`.  `symbols` receives the start of each interval of width 2.  Returns the size. */
static size_t straddle(uint8_t *bytes, size_t capacity, uint32_t run, uint32_t *symbols, bool up) {
    uint64_t distance = UINT64_C(1) << 31; /* of the point from the lower end of the interval */
    gsf_range_encoder encoder;
    gsf_range_encoder_init(&encoder, bytes, capacity);
    for (uint32_t i = 0; i <= run; i++) {
        const uint32_t unit = encoder.range / TOTAL;
        uint32_t range = 2 * unit;
        symbols[i] = (uint32_t)(distance / unit) - 1;
        if (i == run)
            symbols[i] += up ? 2 : (uint32_t)-2;
        gsf_range_encode(&encoder, symbols[i], 2, TOTAL);
        distance -= (uint64_t)symbols[i] * unit;
        for (; range < 1u << 24; range <<= 8)
            distance <<= 8;
    }
    gsf_range_encoder_finish(&encoder);
    return encoder.size;
}

static const uint32_t *straddling;
static symbol straddling_symbol(uint32_t i, uint32_t *state) {
    (void)state;
    return (symbol){straddling[i], 2, TOTAL};
}

/* Runs of held-back bytes, with and without a carry through them. */
static void check_carry(uint32_t run, bool up) {
    const size_t capacity = 2 * (size_t)run + 64;
    uint8_t *bytes = malloc(capacity);
    uint32_t *symbols = malloc((run + 1) * sizeof *symbols);
    assert_true(bytes && symbols);
    const size_t size = straddle(bytes, capacity, run, symbols, up);
    assert_in_range(size, run, capacity);
    assert_int_equal(bytes[0], up ? 0x80 : 0x7F);
    for (uint32_t i = 1; i <= run; i++)
        assert_int_equal(bytes[i], up ? 0x00 : 0xFF);
    straddling = symbols;
    check_decoder(bytes, size, run + 1, straddling_symbol);
    free(symbols);
    free(bytes);
}

static void test_long_carries(void **state) {
    (void)state;
    static const uint32_t runs[] = {1, 2, 3, 4, 5000, 100000};
    for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
        check_carry(runs[i], true);
        check_carry(runs[i], false);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_symbol_alphabets), cmocka_unit_test(test_one_symbol),
        cmocka_unit_test(test_probability_limits),   cmocka_unit_test(test_ten_million_symbols),
        cmocka_unit_test(test_long_carries),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
