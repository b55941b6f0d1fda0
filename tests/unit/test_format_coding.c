/* The entropy coder of the file format: range coder, adaptive models, count splits, sets. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "format/count_split.h"
#include "format/model.h"
#include "format/set.h"

static uint64_t bits[GSF_STREAM_COUNT];

static uint32_t next_random(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

/* Frequencies of three symbols of total `total`, the middle one of the given frequency. */
static void three_symbols(uint16_t freq[3], uint32_t total, uint32_t middle) {
    freq[1] = (uint16_t)middle;
    freq[0] = (uint16_t)((total - middle) / 2);
    freq[2] = (uint16_t)(total - middle - freq[0]);
}

static void random_symbol(uint32_t *state, uint16_t freq[3], uint32_t *total, uint32_t *symbol) {
    *total = 16 + next_random(state) % (GSF_MAX_TOTAL - 15);
    three_symbols(freq, *total, 1 + next_random(state) % (*total - 3));
    *symbol = next_random(state) % 3;
}

static void test_million_symbols(void **unused) {
    (void)unused;
    enum { COUNT = 1000000 };
    uint8_t *bytes = malloc(COUNT * 2 + 16);
    uint16_t freq[3];
    uint32_t state = 1, total, symbol;
    gsf_coder coder;
    gsf_coder_write_to(&coder, bytes, COUNT * 2 + 16, bits);
    for (int i = 0; i < COUNT; i++) {
        random_symbol(&state, freq, &total, &symbol);
        gsf_code_symbol(&coder, symbol, freq, 3, total);
    }
    gsf_range_encoder_finish(&coder.encoder);
    const size_t size = coder.encoder.size;
    assert_true(size <= COUNT * 2 + 16);

    state = 1;
    gsf_coder_read_from(&coder, bytes, size, bits);
    for (int i = 0; i < COUNT; i++) {
        random_symbol(&state, freq, &total, &symbol);
        assert_int_equal(gsf_code_symbol(&coder, 0, freq, 3, total), symbol);
    }
    assert_int_equal(coder.decoder.position, size + GSF_IMPLIED_BYTES);
    assert_false(gsf_coder_overrun(&coder));
    free(bytes);
}

static void test_one_symbol_costs_nothing(void **unused) {
    (void)unused;
    const uint16_t freq[1] = {7};
    uint8_t bytes[8];
    gsf_coder coder;
    gsf_coder_write_to(&coder, bytes, sizeof bytes, bits);
    for (int i = 0; i < 100000; i++) {
        gsf_code_symbol(&coder, 0, freq, 1, 7);
        gsf_code_uniform(&coder, 0, 1);
    }
    gsf_range_encoder_finish(&coder.encoder);
    assert_int_equal(coder.encoder.size, 1);
}

/* The most and the least likely symbol that the coder can express. */
static void test_extreme_frequencies(void **unused) {
    (void)unused;
    const uint16_t freq[2] = {65535, 1};
    uint8_t bytes[4096];
    gsf_coder coder;
    gsf_coder_write_to(&coder, bytes, sizeof bytes, bits);
    for (uint32_t i = 0; i < 50000; i++)
        gsf_code_symbol(&coder, i % 97 == 0, freq, 2, GSF_MAX_TOTAL);
    gsf_range_encoder_finish(&coder.encoder);
    assert_true(coder.encoder.size < 1100);

    gsf_coder_read_from(&coder, bytes, coder.encoder.size, bits);
    for (uint32_t i = 0; i < 50000; i++)
        assert_int_equal(gsf_code_symbol(&coder, 0, freq, 2, GSF_MAX_TOTAL), i % 97 == 0);
}

/* The first byte may be 0xFF. */
static void test_first_byte_full(void **unused) {
    (void)unused;
    uint8_t bytes[64];
    gsf_coder coder;
    gsf_coder_write_to(&coder, bytes, sizeof bytes, bits);
    for (int i = 0; i < 40; i++)
        gsf_code_bits(&coder, 255, 8);
    gsf_range_encoder_finish(&coder.encoder);
    gsf_coder_read_from(&coder, bytes, coder.encoder.size, bits);
    for (int i = 0; i < 40; i++)
        assert_int_equal(gsf_code_bits(&coder, 0, 8), 255);
}

static void test_no_space_is_counted(void **unused) {
    (void)unused;
    uint8_t bytes[4] = {0};
    gsf_range_encoder encoder;
    gsf_range_encoder_init(&encoder, bytes, 2);
    for (uint32_t i = 0; i < 100; i++)
        gsf_range_encode(&encoder, i, 1, 256);
    gsf_range_encoder_finish(&encoder);
    assert_int_equal(encoder.size, 101);
    assert_int_equal(bytes[2], 0);
}

static void test_reading_stops_at_the_end(void **unused) {
    (void)unused;
    gsf_coder coder;
    gsf_coder_read_from(&coder, NULL, 0, bits);
    assert_true(gsf_coder_overrun(&coder)); /* even the shortest payload has a byte */
    for (int i = 0; i < 100; i++)
        gsf_code_bits(&coder, 0, 16);
}

static void test_model_adapts(void **unused) {
    (void)unused;
    static const gsf_model_shape shape = {1, 50, 3, {32, 8, 2}, 64};
    uint16_t freq[40];
    gsf_model model;
    gsf_model_init(&model, &shape, freq, 40, 20);
    assert_int_equal(model.freq[20], 51);
    assert_true(model.freq[19] == model.freq[21] && model.freq[21] < 51);
    for (int i = 0; i < 1000; i++)
        gsf_model_update(&model, i % 2 ? 0 : 39);
    assert_true(model.total <= 40 * 64);
    uint32_t sum = 0;
    for (uint32_t i = 0; i < model.count; i++) {
        assert_true(model.freq[i] > 0);
        sum += model.freq[i];
    }
    assert_int_equal(sum, model.total);
    assert_true(model.freq[0] > model.freq[20] * 100);
}

/* Any count can be coded with any weights. */
static void test_count_split_round_trip(void **unused) {
    (void)unused;
    static const uint32_t sizes[] = {1, 2, 3, 254, 255, 256, 257, 511, 1000, 65537, GSF_MAX_SPLATS};
    static const uint32_t weights[][2] = {{64, 64},       {64, 128}, {1, 65535}, {100000, 63}, {1u << 30, 1u << 30},
                                          {192, 1u << 20}};
    static uint8_t bytes[1 << 16];
    for (int pass = 0; pass < 2; pass++) {
        static gsf_coder coder;
        if (pass == 0)
            gsf_coder_write_to(&coder, bytes, sizeof bytes, bits);
        else
            gsf_coder_read_from(&coder, bytes, coder.encoder.size, bits);
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
            for (size_t j = 0; j < sizeof weights / sizeof *weights; j++) {
                const uint32_t n = sizes[i], counts[] = {0, 1, n / 3, n / 2, n - 1, n};
                for (int k = 0; k < 6; k++)
                    assert_int_equal(
                        gsf_code_count_split(&coder, pass ? 0 : counts[k], n, weights[j][0], weights[j][1]), counts[k]);
            }
        }
        if (pass == 0)
            gsf_range_encoder_finish(&coder.encoder);
        assert_true(coder.encoder.size <= sizeof bytes);
    }
}

/* With both parameters 1 all counts are equally likely.  With large equal parameters the distribution is binomial. */
static void test_count_split_probabilities(void **unused) {
    (void)unused;
    gsf_coder coder;
    uint8_t bytes[64];
    uint64_t cost[GSF_STREAM_COUNT] = {0};
    gsf_coder_write_to(&coder, bytes, sizeof bytes, cost);
    gsf_code_count_split(&coder, 5, 15, 64, 64);
    assert_in_range(cost[0], 4 * 256 - 2, 4 * 256 + 2);
    cost[0] = 0;
    gsf_code_count_split(&coder, 0, 1, 64, 192);
    assert_in_range(cost[0], 105, 107); /* -log2(3/4) */
    cost[0] = 0;
    gsf_code_count_split(&coder, 2, 4, 64 * 1000, 64 * 1000);
    assert_in_range(cost[0], 361, 364); /* -log2(6/16) */
}

static void test_class_counts(void **unused) {
    (void)unused;
    uint32_t counts[1024] = {0}, decoded[1024];
    uint8_t bytes[4096];
    gsf_coder coder;
    counts[3] = 1;
    counts[700] = 100;
    counts[701] = 5000;
    gsf_coder_write_to(&coder, bytes, sizeof bytes, bits);
    gsf_code_class_counts(&coder, counts, 1024, 5101);
    gsf_range_encoder_finish(&coder.encoder);
    memset(decoded, 0xFF, sizeof decoded);
    gsf_coder_read_from(&coder, bytes, coder.encoder.size, bits);
    gsf_code_class_counts(&coder, decoded, 1024, 5101);
    assert_memory_equal(counts, decoded, sizeof counts);
}

/* A split is across the longer side and leaves two parts that are not empty. */
static void test_split_rect(void **unused) {
    (void)unused;
    const gsf_grid grid = {7, 3, 10, 30};
    gsf_split split = gsf_split_rect(&grid, (gsf_rect){0, 0, 7, 3});
    assert_false(split.along_x); /* 70 by 90 */
    gsf_rect second = gsf_half((gsf_rect){0, 0, 7, 3}, &split, true);
    assert_int_equal(gsf_half((gsf_rect){0, 0, 7, 3}, &split, false).height, 1);
    assert_int_equal(second.y, 1);
    assert_int_equal(second.height, 2);
    assert_int_equal(second.width, 7);
    split = gsf_split_rect(&grid, (gsf_rect){2, 1, 3, 1});
    assert_true(split.along_x);
    assert_int_equal(split.at, 3);
    split = gsf_split_rect(&grid, (gsf_rect){2, 1, 1, 2});
    assert_false(split.along_x);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_million_symbols),
        cmocka_unit_test(test_one_symbol_costs_nothing),
        cmocka_unit_test(test_extreme_frequencies),
        cmocka_unit_test(test_first_byte_full),
        cmocka_unit_test(test_no_space_is_counted),
        cmocka_unit_test(test_reading_stops_at_the_end),
        cmocka_unit_test(test_model_adapts),
        cmocka_unit_test(test_count_split_round_trip),
        cmocka_unit_test(test_count_split_probabilities),
        cmocka_unit_test(test_class_counts),
        cmocka_unit_test(test_split_rect),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
