/* Encodes into packets: their limits, and the settings. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>
#include <gscl/measure.h>

#include "encode/repairs.h"
#include "one_context.h"
#include "synthetic_image.h"

enum { PACKET_SIZE = 60 };

static gscl_encode_settings settings_of(uint32_t count, double loss) {
    gscl_encode_settings settings;
    gscl_encode_settings_default(&settings);
    settings.effort = 0;
    settings.packet_size = PACKET_SIZE;
    settings.packet_count = count;
    settings.packet_loss = loss;
    return settings;
}

/* A list that was encoded, with what is in it. */
typedef struct {
    uint8_t *bytes;
    size_t size;
    gscl_encode_report report;
    uint32_t packets, repairs, splats; /* the splats of all packets */
    size_t sum;                        /* bytes of all packets */
} encoded_list;

static void inspect_packets(encoded_list *list, size_t limit) {
    size_t position = 0, size;
    const uint8_t *packet;
    while (gscl_next_packet(list->bytes, list->size, &position, &packet, &size)) {
        gscl_packet_info info = {.struct_size = sizeof info};
        assert_int_equal(gscl_packet_probe(packet, size, &info), GSCL_OK);
        assert_int_equal(info.number, list->packets + list->repairs);
        assert_in_range(size, 1, limit);
        list->packets += !info.repair;
        list->repairs += info.repair;
        list->splats += info.splats;
        list->sum += size;
    }
    assert_int_equal(position, list->size);
}

/* The report says what the list holds and how it is drawn. */
static void check_report(const gscl_image *image, const encoded_list *list) {
    gscl_info info = {.struct_size = sizeof info};
    gscl_image drawn = {0};
    gscl_comparison comparison = {.struct_size = sizeof comparison};
    assert_int_equal(gscl_inspect(list->bytes, list->size, NULL, &info), GSCL_OK);
    assert_int_equal(info.splats, list->report.splats);
    assert_int_equal(info.splats, list->splats);
    assert_int_equal(info.packets, list->packets);
    assert_int_equal(list->report.bytes, list->sum);
    assert_int_equal(gscl_decode(context, list->bytes, list->size, NULL, &drawn), GSCL_OK);
    assert_int_equal(gscl_compare(image, &drawn, &comparison), GSCL_OK);
    assert_true(comparison.psnr == list->report.psnr || fabs(comparison.psnr - list->report.psnr) < 1e-3);
    gscl_free(drawn.pixels);
}

static encoded_list encode(const gscl_image *image, const gscl_encode_settings *settings) {
    encoded_list list = {.report.struct_size = sizeof list.report};
    const gscl_result result = gscl_encode(context, image, settings, &list.bytes, &list.size, &list.report);
    if (result != GSCL_OK)
        fail_msg("%ux%u, %u packets: %s", image->width, image->height, settings->packet_count,
                 gscl_context_message(context));
    inspect_packets(&list, settings->packet_size);
    check_report(image, &list);
    return list;
}

/* Encodes into a number of packets, which must all be there. */
static void check_count(const gscl_image *image, uint32_t count, double loss) {
    const gscl_encode_settings settings = settings_of(count, loss);
    encoded_list list = encode(image, &settings);
    assert_int_equal(list.packets + list.repairs, count);
    if (loss == 0)
        assert_int_equal(list.repairs, 0);
    else if (count >= 10)
        assert_in_range(list.repairs, (uint32_t)(count * loss), count - 1);
    gscl_free(list.bytes);
}

static void check_counts(synthetic_image_kind kind, uint32_t width, uint32_t height, uint32_t channels,
                         gscl_sample sample) {
    static const uint32_t counts[] = {1, 2, 3, 10, 40};
    gscl_image image = synthetic_image(kind, width, height, channels, sample);
    assert_non_null(image.pixels);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        check_count(&image, counts[i], 0);
        check_count(&image, counts[i], 0.3);
    }
    synthetic_image_free(&image);
}

static void test_numbers_of_packets(void **state) {
    (void)state;
    check_counts(SYNTHETIC_SHAPES, 64, 48, 3, GSCL_SAMPLE_U8);
    check_counts(SYNTHETIC_NOISE, 40, 60, 3, GSCL_SAMPLE_U8);
}

static void test_layouts(void **state) {
    (void)state;
    for (uint32_t channels = 1; channels <= 4; channels++)
        check_counts(SYNTHETIC_TEXTURE, 30, 20, channels, channels % 2 ? GSCL_SAMPLE_U16 : GSCL_SAMPLE_U8);
}

static void test_flat_pictures(void **state) {
    (void)state;
    check_counts(SYNTHETIC_FLAT, 50, 40, 3, GSCL_SAMPLE_U8);
    check_counts(SYNTHETIC_FLAT, 50, 40, 4, GSCL_SAMPLE_U16);
}

static void test_tiny_pictures(void **state) {
    (void)state;
    static const uint32_t sizes[][2] = {{1, 1}, {2, 1}, {3, 2}, {1, 70}, {150, 2}, {7, 7}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        check_counts(SYNTHETIC_NOISE, sizes[i][0], sizes[i][1], 3, GSCL_SAMPLE_U8);
}

static void test_largest_numbers(void **state) {
    (void)state;
    gscl_image image = synthetic_image(SYNTHETIC_TEXTURE, 64, 48, 3, GSCL_SAMPLE_U8);
    gscl_encode_settings settings = settings_of(GSCL_MAX_PACKETS, 0.2);
    settings.packet_size = GSCL_MIN_PACKET_SIZE;
    encoded_list list = encode(&image, &settings);
    assert_int_equal(list.packets + list.repairs, GSCL_MAX_PACKETS);
    gscl_free(list.bytes);
    settings = settings_of(1, 0);
    settings.packet_size = GSCL_MAX_PACKET_SIZE;
    list = encode(&image, &settings);
    assert_in_range(list.sum, GSCL_MAX_PACKET_SIZE * 9 / 10, GSCL_MAX_PACKET_SIZE);
    gscl_free(list.bytes);
    synthetic_image_free(&image);
}

/* Ten packets arrive whole in at least 94 of 100 cases, and more loss never takes fewer repair packets. */
static void test_repairs_follow_the_loss(void **state) {
    (void)state;
    assert_int_equal(gscl_choose_repairs(10, 0), 0);
    assert_int_equal(gscl_choose_repairs(10, 0.05), 2);
    assert_int_equal(gscl_choose_repairs(10, 0.1), 3);
    assert_int_equal(gscl_choose_repairs(10, 0.2), 5);
    assert_int_equal(gscl_choose_repairs(10, 0.4), 6);
    for (uint32_t all = 1; all <= GSCL_MAX_PACKETS; all += 9)
        for (int percent = 0, before = 0; percent <= 90; percent++) {
            const int repairs = (int)gscl_choose_repairs(all, percent / 100.0);
            assert_in_range(repairs, before, (int)all - 1);
            before = repairs;
        }
}

/* A target in bytes is that of all packets, repair packets included. */
static void test_targets(void **state) {
    (void)state;
    gscl_image image = synthetic_image(SYNTHETIC_TEXTURE, 64, 48, 3, GSCL_SAMPLE_U8);
    for (uint32_t bytes = 40; bytes <= 1240; bytes += 240)
        for (int loss = 0; loss < 2; loss++) {
            gscl_encode_settings settings = settings_of(0, 0.25 * loss);
            settings.target = loss ? GSCL_TARGET_BPP : GSCL_TARGET_BYTES;
            settings.target_value = loss ? 8.0 * bytes / (64 * 48) : bytes;
            encoded_list list = encode(&image, &settings);
            assert_in_range(list.sum, bytes * 3 / 4, bytes);
            assert_in_range(list.packets + list.repairs, 1, (bytes + PACKET_SIZE - 1) / PACKET_SIZE);
            gscl_free(list.bytes);
        }
    synthetic_image_free(&image);
}

static void test_identities(void **state) {
    (void)state;
    gscl_image image = synthetic_image(SYNTHETIC_SHAPES, 40, 30, 3, GSCL_SAMPLE_U8);
    static const uint32_t identities[] = {0, 1, 198, 200, 255};
    for (size_t i = 0; i < sizeof identities / sizeof *identities; i++) {
        gscl_encode_settings settings = settings_of(4, 0.2);
        size_t position = 0, size;
        const uint8_t *packet;
        settings.packet_identity = identities[i];
        encoded_list list = encode(&image, &settings);
        const uint8_t first = list.bytes[5];
        assert_true(first != 0 && first != 199 && (identities[i] == 0 || first == identities[i]));
        while (gscl_next_packet(list.bytes, list.size, &position, &packet, &size))
            assert_int_equal(packet[0], first);
        gscl_free(list.bytes);
    }
    synthetic_image_free(&image);
}

/* The same picture and seed give the same bytes. */
static void test_repeatable(void **state) {
    (void)state;
    gscl_image image = synthetic_image(SYNTHETIC_TEXTURE, 64, 48, 3, GSCL_SAMPLE_U8);
    const gscl_encode_settings settings = settings_of(6, 0.3);
    encoded_list first = encode(&image, &settings), second = encode(&image, &settings);
    assert_int_equal(first.size, second.size);
    assert_memory_equal(first.bytes, second.bytes, first.size);
    gscl_free(first.bytes);
    gscl_free(second.bytes);
    synthetic_image_free(&image);
}

/* ---- Settings that are refused ---- */

static void assert_refused(gscl_encode_settings settings, gscl_result expected) {
    gscl_image image = synthetic_image(SYNTHETIC_SHAPES, 40, 30, 3, GSCL_SAMPLE_U8);
    uint8_t *bytes = NULL;
    size_t size;
    const gscl_result result = gscl_encode(context, &image, &settings, &bytes, &size, NULL);
    if (result != expected)
        fail_msg("%s (%s); expected: %s", gscl_result_text(result), gscl_context_message(context),
                 gscl_result_text(expected));
    assert_true(strlen(gscl_context_message(context)) > 10);
    assert_null(bytes);
    synthetic_image_free(&image);
}

#define ASSERT_REFUSED(field, value, expected)             \
    do {                                                   \
        gscl_encode_settings settings = settings_of(0, 0); \
        settings.field = (value);                          \
        assert_refused(settings, expected);                \
    } while (0)

static void test_ranges(void **state) {
    (void)state;
    ASSERT_REFUSED(packet_size, GSCL_MIN_PACKET_SIZE - 1, GSCL_ERROR_INVALID_ARGUMENT);
    ASSERT_REFUSED(packet_size, GSCL_MAX_PACKET_SIZE + 1, GSCL_ERROR_INVALID_ARGUMENT);
    ASSERT_REFUSED(packet_size, 1, GSCL_ERROR_INVALID_ARGUMENT);
    ASSERT_REFUSED(packet_count, GSCL_MAX_PACKETS + 1, GSCL_ERROR_INVALID_ARGUMENT);
    ASSERT_REFUSED(packet_identity, 199, GSCL_ERROR_INVALID_ARGUMENT);
    ASSERT_REFUSED(packet_identity, 256, GSCL_ERROR_INVALID_ARGUMENT);
    ASSERT_REFUSED(packet_loss, -0.01, GSCL_ERROR_INVALID_ARGUMENT);
    ASSERT_REFUSED(packet_loss, 0.91, GSCL_ERROR_INVALID_ARGUMENT);
    ASSERT_REFUSED(packet_loss, NAN, GSCL_ERROR_INVALID_ARGUMENT);
}

static void test_conflicts(void **state) {
    (void)state;
    const gscl_block block = {.type = GSCL_BLOCK_XMP, .data = "x", .size = 1};
    ASSERT_REFUSED(profile, GSCL_PROFILE_PAPER, GSCL_ERROR_CONFLICT);
    ASSERT_REFUSED(bare, true, GSCL_ERROR_CONFLICT);
    ASSERT_REFUSED(progressive, true, GSCL_ERROR_CONFLICT);
    ASSERT_REFUSED(blocks, &block, GSCL_ERROR_CONFLICT);
    for (gscl_target target = GSCL_TARGET_BYTES; target <= GSCL_TARGET_QUALITY; target++) {
        gscl_encode_settings settings = settings_of(0, 0);
        settings.target = target;
        settings.target_value = target == GSCL_TARGET_BYTES ? 1e6 : 20; /* more than 256 packets */
        assert_refused(settings, GSCL_ERROR_CONFLICT);
        settings.packet_count = 4;
        settings.target_value = target == GSCL_TARGET_BYTES ? 200 : 1;
        assert_refused(settings, GSCL_ERROR_CONFLICT);
    }
    for (int i = 0; i < 3; i++) {
        gscl_encode_settings settings = settings_of(0, 0);
        settings.packet_size = 0;
        settings.packet_count = i == 0 ? 4 : 0;
        settings.packet_identity = i == 1 ? 4 : 0;
        settings.packet_loss = i == 2 ? 0.1 : 0;
        assert_refused(settings, GSCL_ERROR_CONFLICT);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_repairs_follow_the_loss),
        cmocka_unit_test(test_numbers_of_packets),
        cmocka_unit_test(test_layouts),
        cmocka_unit_test(test_flat_pictures),
        cmocka_unit_test(test_tiny_pictures),
        cmocka_unit_test(test_largest_numbers),
        cmocka_unit_test(test_targets),
        cmocka_unit_test(test_identities),
        cmocka_unit_test(test_repeatable),
        cmocka_unit_test(test_ranges),
        cmocka_unit_test(test_conflicts),
    };
    return cmocka_run_group_tests(tests, open_context, close_context);
}
