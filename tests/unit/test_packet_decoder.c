/* The library's functions for packets that come one by one, and for files that come in pieces. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>

#include "devices.h"
#include "format/packet.h"
#include "synthetic_packets.h"

enum { WIDTH = 40, HEIGHT = 30, SPLATS = 60, PACKETS = 4, REPAIRS = 2 };

static gscl_context *context;
static synthetic_packets packets; /* with repair packets behind them */
static synthetic_packets others;  /* of a picture with another seed, of the same identity and size */

static synthetic_packets divided(uint32_t seed, uint32_t splats, uint32_t width, uint8_t identity) {
    synthetic_packets made;
    synthetic_random_state = seed;
    synthetic_scene *scene = synthetic_divisible_scene(2, width, HEIGHT, splats);
    assert_non_null(scene);
    scene->image.header.has_texture = false;
    scene->image.has_mean_background = false;
    for (int i = 0; i < GSF_MAX_CHANNELS; i++)
        scene->image.background[i] = (uint16_t)(50 * i);
    assert_true(synthetic_packets_write(&scene->image, PACKETS, REPAIRS, identity, &made));
    synthetic_scene_free(scene);
    return made;
}

static int open_packets(void **unused) {
    (void)unused;
    packets = divided(3, SPLATS, WIDTH, 7);
    others = divided(4, SPLATS, WIDTH, 7);
    return open_on(&context, GSCL_HOST_DEVICE, GSCL_MAPPING_AUTO) ? 0 : -1;
}

static int close_packets(void **unused) {
    (void)unused;
    synthetic_packets_free(&packets);
    synthetic_packets_free(&others);
    gscl_context_free(&context);
    return 0;
}

/* ---- Lists ---- */

static uint8_t *whole_list(size_t *size) {
    static const uint32_t numbers[] = {0, 1, 2, 3, 4, 5};
    uint8_t *list = synthetic_list(&packets, numbers, PACKETS + REPAIRS, size);
    assert_non_null(list);
    return list;
}

static void test_next_packet(void **unused) {
    (void)unused;
    size_t size, position = 0, packet_size = 0;
    const uint8_t *packet = NULL;
    uint8_t *list = whole_list(&size);
    for (uint32_t i = 0; i < PACKETS + REPAIRS; i++) {
        assert_true(gscl_next_packet(list, size, &position, &packet, &packet_size));
        assert_int_equal(packet_size, packets.packets[i].size);
        assert_memory_equal(packet, packets.packets[i].data, packet_size);
    }
    assert_int_equal(position, size);
    assert_false(gscl_next_packet(list, size, &position, &packet, &packet_size));
    assert_int_equal(position, size);
    assert_int_equal(packet_size, packets.packets[PACKETS + REPAIRS - 1].size);
    free(list);
}

static void test_next_packet_of_no_list(void **unused) {
    (void)unused;
    size_t size, position = 0, packet_size = 77;
    const uint8_t *packet = NULL;
    uint8_t *list = whole_list(&size);
    for (size_t cut = 0; cut < 5 + packets.packets[0].size; cut++)
        assert_false(gscl_next_packet(list, cut, &position, &packet, &packet_size));
    assert_false(gscl_next_packet(NULL, size, &position, &packet, &packet_size));
    assert_false(gscl_next_packet(list, size, NULL, &packet, &packet_size));
    assert_false(gscl_next_packet(list, size, &position, NULL, &packet_size));
    assert_false(gscl_next_packet(list, size, &position, &packet, NULL));
    list[3] = 'c';
    assert_false(gscl_next_packet(list, size, &position, &packet, &packet_size));
    assert_true(position == 0 && !packet && packet_size == 77);
    free(list);
}

static void test_append_packet(void **unused) {
    (void)unused;
    size_t expected_size, size = 0;
    uint8_t *expected = whole_list(&expected_size), *list = NULL;
    for (uint32_t i = 0; i < PACKETS + REPAIRS; i++)
        assert_int_equal(gscl_append_packet(&list, &size, packets.packets[i].data, packets.packets[i].size), GSCL_OK);
    assert_int_equal(size, expected_size);
    assert_memory_equal(list, expected, size);
    free(expected);
    gscl_free(list);
}

/* Packets of 127, 128 and 16384 bytes have sizes of one to three bytes. */
static void test_append_long_packets(void **unused) {
    (void)unused;
    static const size_t sizes[] = {1, 127, 128, 16383, 16384, (1u << 21) - 1};
    static uint8_t bytes[1u << 21];
    size_t size = 0, position = 0, packet_size;
    const uint8_t *packet;
    uint8_t *list = NULL;
    for (size_t i = 0; i < 6; i++)
        assert_int_equal(gscl_append_packet(&list, &size, bytes, sizes[i]), GSCL_OK);
    for (size_t i = 0; i < 6; i++) {
        assert_true(gscl_next_packet(list, size, &position, &packet, &packet_size));
        assert_int_equal(packet_size, sizes[i]);
    }
    assert_int_equal(gscl_append_packet(&list, &size, bytes, sizeof bytes), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(position, size);
    gscl_free(list);
}

static void test_append_packet_to_no_list(void **unused) {
    (void)unused;
    uint8_t bytes[] = "gscl", *list = NULL, *no_list = bytes;
    size_t size = 0;
    assert_int_equal(gscl_append_packet(NULL, &size, bytes, 4), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_append_packet(&list, NULL, bytes, 4), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_append_packet(&list, &size, NULL, 4), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_append_packet(&list, &size, bytes, 0), GSCL_ERROR_INVALID_ARGUMENT);
    size = 4;
    assert_int_equal(gscl_append_packet(&no_list, &size, bytes, 4), GSCL_ERROR_INVALID_ARGUMENT);
    assert_true(!list && no_list == bytes && size == 4);
}

/* ---- Probes ---- */

static gscl_result probe(gsf_bytes packet, gscl_packet_info *info) {
    info->struct_size = sizeof *info;
    return gscl_packet_probe(packet.data, packet.size, info);
}

static void test_probe(void **unused) {
    (void)unused;
    gscl_packet_info info;
    uint32_t splats = 0;
    for (uint32_t i = 0; i < PACKETS + REPAIRS; i++) {
        assert_int_equal(probe(packets.packets[i], &info), GSCL_OK);
        assert_int_equal(info.identity, 7);
        assert_int_equal(info.number, i);
        assert_int_equal(info.repair, i >= PACKETS);
        assert_int_equal(info.count, i < PACKETS ? PACKETS : 0);
        assert_int_equal(info.width, i < PACKETS ? WIDTH : 0);
        assert_int_equal(info.height, i < PACKETS ? HEIGHT : 0);
        splats += info.splats;
    }
    assert_int_equal(splats, SPLATS);
}

static void test_probe_errors(void **unused) {
    (void)unused;
    gscl_packet_info info = {.struct_size = sizeof info};
    for (uint32_t i = 0; i < PACKETS + REPAIRS; i += PACKETS) {
        const gsf_bytes packet = packets.packets[i];
        uint8_t copy[500];
        for (size_t at = 0; at < packet.size; at++) {
            memcpy(copy, packet.data, packet.size);
            copy[at] ^= 2;
            assert_int_equal(gscl_packet_probe(copy, packet.size, &info), GSCL_ERROR_DAMAGED);
        }
        for (size_t size = 0; size < packet.size; size++)
            assert_int_equal(gscl_packet_probe(packet.data, size, &info),
                             size <= 3 ? GSCL_ERROR_TRUNCATED : GSCL_ERROR_DAMAGED);
    }
    assert_int_equal(gscl_packet_probe((const uint8_t *)"\xC7gsc\2", 5, &info), GSCL_ERROR_NOT_GSCL);
    assert_int_equal(gscl_packet_probe(NULL, 5, &info), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_packet_probe(packets.packets[0].data, 5, NULL), GSCL_ERROR_INVALID_ARGUMENT);
    static const size_t wrong[] = {0, 1, sizeof info + 1, SIZE_MAX};
    for (size_t i = 0; i < 4; i++) {
        info.struct_size = wrong[i];
        assert_int_equal(gscl_packet_probe(packets.packets[0].data, packets.packets[0].size, &info),
                         GSCL_ERROR_STRUCT_SIZE);
    }
}

/* A packet that ends in its header, with a check that matches. */
static void test_probe_of_a_short_header(void **unused) {
    (void)unused;
    gscl_packet_info info = {.struct_size = sizeof info};
    uint8_t packet[10] = {7, packets.packets[0].data[1]};
    assert_int_equal(gsf_put_packet_frame(packet, 1, 7), 4);
    assert_int_equal(gscl_packet_probe(packet, 4, &info), GSCL_ERROR_CORRUPT);
}

/* ---- Decoders ---- */

static gscl_decoder *decoder_of(const gscl_decode_settings *settings) {
    gscl_decoder *decoder = NULL;
    assert_int_equal(gscl_decoder_create(&decoder, settings), GSCL_OK);
    return decoder;
}

static gscl_result add(gscl_decoder *decoder, gsf_bytes packet) {
    return gscl_decoder_add_packet(decoder, packet.data, packet.size);
}

static gscl_decoder_state state_of(const gscl_decoder *decoder) {
    gscl_decoder_state state = {.struct_size = sizeof state};
    assert_int_equal(gscl_decoder_inspect(decoder, &state), GSCL_OK);
    return state;
}

static void assert_counts(const gscl_decoder *decoder, uint32_t drawn, uint32_t received) {
    const gscl_decoder_state state = state_of(decoder);
    assert_int_equal(state.drawn, drawn);
    assert_int_equal(state.received, received);
}

static void assert_equal_images(const gscl_image *a, const gscl_image *b) {
    assert_true(a->width == b->width && a->height == b->height && a->channels == b->channels && a->sample == b->sample);
    assert_memory_equal(a->pixels, b->pixels,
                        (size_t)a->width * a->height * a->channels * (a->sample == GSCL_SAMPLE_U16 ? 2 : 1));
}

/* The decoder draws what a decode of these bytes draws. */
static void assert_draws(gscl_decoder *decoder, const uint8_t *bytes, size_t size,
                         const gscl_decode_settings *settings) {
    gscl_image drawn = {0}, expected = {0};
    assert_int_equal(gscl_decoder_draw(decoder, context, &drawn), GSCL_OK);
    assert_int_equal(gscl_decode(context, bytes, size, settings, &expected), GSCL_OK);
    assert_equal_images(&drawn, &expected);
    gscl_free(drawn.pixels);
    gscl_free(expected.pixels);
}

static void assert_draws_packets(gscl_decoder *decoder, const uint32_t *numbers, uint32_t count) {
    size_t size;
    uint8_t *list = synthetic_list(&packets, numbers, count, &size);
    assert_non_null(list);
    assert_draws(decoder, list, size, NULL);
    free(list);
}

static void test_every_order(void **unused) {
    (void)unused;
    static const uint32_t sorted[] = {0, 1, 2, 3};
    for (uint32_t order = 0; order < 24; order++) {
        uint32_t left[PACKETS] = {0, 1, 2, 3}, numbers[PACKETS], rest = order;
        gscl_decoder *decoder = decoder_of(NULL);
        for (uint32_t i = 0; i < PACKETS; i++) {
            const uint32_t at = rest % (PACKETS - i);
            rest /= PACKETS - i;
            numbers[i] = left[at];
            left[at] = left[PACKETS - 1 - i];
            assert_int_equal(add(decoder, packets.packets[numbers[i]]), GSCL_OK);
            assert_counts(decoder, i + 1, i + 1);
            assert_draws_packets(decoder, numbers, i + 1);
        }
        assert_int_equal(state_of(decoder).packets, PACKETS);
        assert_int_equal(state_of(decoder).splats, SPLATS);
        assert_int_equal(state_of(decoder).width, WIDTH);
        assert_draws_packets(decoder, sorted, PACKETS);
        gscl_decoder_free(&decoder);
        assert_null(decoder);
    }
}

/* What comes twice, is damaged or of another picture changes nothing. */
static void test_useless_packets(void **unused) {
    (void)unused;
    static const uint32_t two[] = {0, 2};
    synthetic_packets wider = divided(3, SPLATS, WIDTH + 1, 7), named = divided(3, SPLATS, WIDTH, 8);
    uint8_t copy[500];
    gscl_decoder *decoder = decoder_of(NULL);
    assert_int_equal(add(decoder, packets.packets[0]), GSCL_OK);
    assert_int_equal(add(decoder, packets.packets[2]), GSCL_OK);
    const gscl_decoder_state before = state_of(decoder);
    assert_int_equal(add(decoder, packets.packets[0]), GSCL_OK);
    assert_int_equal(add(decoder, named.packets[1]), GSCL_ERROR_OTHER_PICTURE);
    assert_int_equal(add(decoder, wider.packets[1]), GSCL_ERROR_OTHER_PICTURE);
    assert_int_equal(add(decoder, named.packets[PACKETS]), GSCL_ERROR_OTHER_PICTURE);
    memcpy(copy, packets.packets[1].data, packets.packets[1].size);
    copy[6] ^= 1;
    assert_int_equal(gscl_decoder_add_packet(decoder, copy, packets.packets[1].size), GSCL_ERROR_DAMAGED);
    assert_int_equal(gscl_decoder_add_packet(decoder, copy, 2), GSCL_ERROR_TRUNCATED);
    const size_t longer = gsf_put_packet_frame(copy, packets.packets[1].size - GSF_PACKET_FRAME + 1, 7);
    assert_int_equal(gscl_decoder_add_packet(decoder, copy, longer), GSCL_ERROR_CORRUPT);
    const gscl_decoder_state after = state_of(decoder);
    assert_memory_equal(&before, &after, sizeof after);
    assert_draws_packets(decoder, two, 2);
    gscl_decoder_free(&decoder);
    synthetic_packets_free(&wider);
    synthetic_packets_free(&named);
}

/* Steps and background must be equal, too. */
static void test_packets_with_other_steps(void **unused) {
    (void)unused;
    synthetic_packets made;
    synthetic_random_state = 3;
    synthetic_scene *scene = synthetic_divisible_scene(2, WIDTH, HEIGHT, SPLATS);
    assert_non_null(scene);
    scene->image.header.has_texture = false;
    assert_true(synthetic_packets_write(&scene->image, PACKETS, 0, 7, &made));
    gscl_decoder *decoder = decoder_of(NULL);
    assert_int_equal(add(decoder, packets.packets[0]), GSCL_OK);
    assert_int_equal(add(decoder, made.packets[1]), GSCL_ERROR_OTHER_PICTURE);
    assert_counts(decoder, 1, 1);
    assert_int_equal(add(decoder, packets.packets[1]), GSCL_OK);
    assert_counts(decoder, 2, 2);
    gscl_decoder_free(&decoder);
    synthetic_packets_free(&made);
    synthetic_scene_free(scene);
}

static void test_repair_packets(void **unused) {
    (void)unused;
    static const uint32_t numbers[] = {0, 1, 2, 3};
    gscl_decoder *decoder = decoder_of(NULL);
    gscl_image image = {0};
    gscl_decoder_state state = {.struct_size = sizeof state};
    assert_int_equal(add(decoder, packets.packets[5]), GSCL_OK);
    assert_int_equal(gscl_decoder_draw(decoder, context, &image), GSCL_ERROR_TRUNCATED);
    assert_int_equal(gscl_decoder_inspect(decoder, &state), GSCL_OK);
    assert_true(state.drawn == 0 && state.received == 1 && state.packets == 0 && state.width == 0);
    assert_int_equal(add(decoder, packets.packets[1]), GSCL_OK);
    assert_counts(decoder, 1, 2);
    assert_int_equal(add(decoder, packets.packets[4]), GSCL_OK);
    assert_counts(decoder, 1, 3);
    assert_int_equal(add(decoder, packets.packets[4]), GSCL_OK);
    assert_counts(decoder, 1, 3);
    assert_int_equal(add(decoder, packets.packets[3]), GSCL_OK);
    assert_counts(decoder, 4, 4);
    assert_draws_packets(decoder, numbers, PACKETS);
    assert_int_equal(add(decoder, packets.packets[0]), GSCL_OK); /* is there already */
    assert_counts(decoder, 4, 5);
    assert_draws_packets(decoder, numbers, PACKETS);
    gscl_decoder_free(&decoder);
}

/* Repair packets of another picture of the same identity give nothing wrong. */
static void test_repair_packets_of_another_picture(void **unused) {
    (void)unused;
    static const uint32_t numbers[] = {1, 3, 0, 2};
    gscl_decoder *decoder = decoder_of(NULL);
    assert_int_equal(add(decoder, others.packets[4]), GSCL_OK);
    assert_int_equal(add(decoder, others.packets[5]), GSCL_OK);
    for (uint32_t i = 0; i < PACKETS; i++) {
        assert_int_equal(add(decoder, packets.packets[numbers[i]]), GSCL_OK);
        assert_counts(decoder, i + 1, i + 3);
        assert_draws_packets(decoder, numbers, i + 1);
    }
    gscl_decoder_free(&decoder);
}

/* A picture with fewer splats than packets: those without splats may come first. */
static void test_packets_without_splats(void **unused) {
    (void)unused;
    synthetic_packets few = divided(12, 1, WIDTH, 7);
    uint32_t drawn = 0;
    gscl_packet_info info;
    gscl_decoder *decoder = decoder_of(NULL);
    for (uint32_t splats = 0; splats < 2; splats++)
        for (uint32_t i = 0; i < PACKETS; i++) {
            assert_int_equal(probe(few.packets[i], &info), GSCL_OK);
            if (info.splats == splats) {
                assert_int_equal(add(decoder, few.packets[i]), GSCL_OK);
                assert_counts(decoder, drawn + 1, drawn + 1);
                drawn++;
            }
        }
    assert_int_equal(drawn, PACKETS);
    assert_int_equal(state_of(decoder).splats, 1);
    gscl_decoder_free(&decoder);
    synthetic_packets_free(&few);
}

/* Random changes of packets whose checks then match: whatever comes, the decoder draws what is valid. */
static void test_changed_packets(void **unused) {
    (void)unused;
    uint32_t taken = 0;
    for (int round = 0; round < 100; round++) {
        gscl_decoder *decoder = decoder_of(NULL);
        for (uint32_t i = 0; i < 2 * PACKETS; i++) {
            uint8_t copy[500];
            const gsf_bytes packet = packets.packets[synthetic_random(PACKETS)];
            memcpy(copy, packet.data, packet.size);
            for (uint32_t changes = synthetic_random(3); changes > 0; changes--)
                copy[1 + synthetic_random((uint32_t)packet.size - 3)] ^= (uint8_t)(1u << synthetic_random(8));
            const size_t size = gsf_put_packet_frame(copy, packet.size - GSF_PACKET_FRAME, 7);
            const gscl_result result = gscl_decoder_add_packet(decoder, copy, size);
            assert_true(result == GSCL_OK || result == GSCL_ERROR_CORRUPT || result == GSCL_ERROR_OTHER_PICTURE);
            taken += result == GSCL_OK;
        }
        gscl_image image = {0};
        gscl_decoder_state state = {.struct_size = sizeof state};
        const gscl_result inspected = gscl_decoder_inspect(decoder, &state);
        if (inspected == GSCL_OK && (uint64_t)state.width * state.height < 100000)
            assert_int_equal(gscl_decoder_draw(decoder, context, &image), GSCL_OK);
        gscl_free(image.pixels);
        gscl_decoder_free(&decoder);
    }
    assert_true(taken > 100);
}

/* The settings are those of each drawing. */
static void test_settings(void **unused) {
    (void)unused;
    static const uint32_t numbers[] = {0, 1, 2, 3};
    size_t size;
    gscl_decode_settings settings;
    gscl_decode_settings_default(&settings);
    settings.width = 2 * WIDTH;
    settings.height = HEIGHT;
    settings.crop_x = 7;
    settings.crop_width = 30;
    gscl_decoder *decoder = decoder_of(&settings);
    uint8_t *list = synthetic_list(&packets, numbers, PACKETS, &size);
    assert_non_null(list);
    for (uint32_t i = 0; i < PACKETS; i++)
        assert_int_equal(add(decoder, packets.packets[i]), GSCL_OK);
    assert_draws(decoder, list, size, &settings);
    free(list);
    gscl_decoder_free(&decoder);
    settings.struct_size++;
    assert_int_equal(gscl_decoder_create(&decoder, &settings), GSCL_ERROR_STRUCT_SIZE);
    assert_null(decoder);
}

/* ---- Files in pieces ---- */

/* After each piece the decoder draws what a partial decode of the bytes so far draws, and fails where that fails. */
static void check_pieces(const uint8_t *bytes, size_t size, size_t piece) {
    gscl_decode_settings partial;
    gscl_decode_settings_default(&partial);
    partial.partial = true;
    gscl_decoder *decoder = decoder_of(NULL);
    uint32_t before = 0, total = 0;
    for (size_t come = 0; come < size;) {
        const size_t next = size - come < piece ? size - come : piece;
        gscl_decoder_state state = {.struct_size = sizeof state};
        gscl_image image = {0};
        assert_int_equal(gscl_decoder_add_bytes(decoder, bytes + come, next), GSCL_OK);
        come += next;
        const gscl_result expected = gscl_decode(context, bytes, come, &partial, &image);
        gscl_free(image.pixels);
        image.pixels = NULL;
        if (expected != GSCL_OK) {
            assert_int_equal(gscl_decoder_draw(decoder, context, &image), expected);
            assert_int_not_equal(gscl_decoder_inspect(decoder, &state), GSCL_OK);
            continue;
        }
        assert_draws(decoder, bytes, come, &partial);
        state = state_of(decoder);
        assert_true(state.bytes == come && state.splats >= before && state.width == WIDTH);
        assert_int_equal(gscl_certain_splats(bytes, come, NULL, &before, &total), GSCL_OK);
        assert_int_equal(state.splats, before);
    }
    assert_int_equal(before, SPLATS);
    gscl_decoder_free(&decoder);
}

static void test_pieces(void **unused) {
    (void)unused;
    uint8_t *bytes = NULL;
    size_t size;
    assert_true(synthetic_file(WIDTH, HEIGHT, SPLATS, &bytes, &size));
    check_pieces(bytes, size, 9);
    check_pieces(bytes, size, size);
    free(bytes);
    bytes = whole_list(&size);
    check_pieces(bytes, size, 13);
    free(bytes);
}

/* Bytes and packets are not mixed. */
static void test_mixed_input(void **unused) {
    (void)unused;
    gscl_decoder *decoder = decoder_of(NULL);
    assert_int_equal(add(decoder, packets.packets[0]), GSCL_OK);
    assert_int_equal(gscl_decoder_add_bytes(decoder, packets.packets[0].data, 5), GSCL_ERROR_INVALID_ARGUMENT);
    assert_counts(decoder, 1, 1);
    gscl_decoder_free(&decoder);
    decoder = decoder_of(NULL);
    size_t size;
    uint8_t *list = whole_list(&size);
    assert_int_equal(gscl_decoder_add_bytes(decoder, list, size), GSCL_OK);
    assert_int_equal(add(decoder, packets.packets[0]), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(state_of(decoder).bytes, size);
    free(list);
    gscl_decoder_free(&decoder);
}

static void test_missing_arguments(void **unused) {
    (void)unused;
    gscl_decoder *decoder = decoder_of(NULL), *none = NULL;
    gscl_image image = {0};
    gscl_decoder_state state = {.struct_size = sizeof state};
    const gsf_bytes packet = packets.packets[0];
    assert_int_equal(gscl_decoder_create(NULL, NULL), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_decoder_add_packet(NULL, packet.data, packet.size), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_decoder_add_packet(decoder, NULL, packet.size), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_decoder_add_bytes(NULL, packet.data, packet.size), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_decoder_add_bytes(decoder, NULL, packet.size), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_decoder_inspect(NULL, &state), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_decoder_inspect(decoder, NULL), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_decoder_inspect(decoder, &state), GSCL_ERROR_TRUNCATED);
    assert_int_equal(gscl_decoder_draw(decoder, context, &image), GSCL_ERROR_TRUNCATED);
    assert_int_equal(add(decoder, packet), GSCL_OK);
    assert_int_equal(gscl_decoder_draw(NULL, context, &image), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_decoder_draw(decoder, NULL, &image), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_decoder_draw(decoder, context, NULL), GSCL_ERROR_INVALID_ARGUMENT);
    state.struct_size = 3;
    assert_int_equal(gscl_decoder_inspect(decoder, &state), GSCL_ERROR_STRUCT_SIZE);
    state.struct_size = sizeof state + 1;
    assert_int_equal(gscl_decoder_inspect(decoder, &state), GSCL_ERROR_STRUCT_SIZE);
    gscl_decoder_free(&decoder);
    gscl_decoder_free(&none);
    gscl_decoder_free(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_next_packet),
        cmocka_unit_test(test_next_packet_of_no_list),
        cmocka_unit_test(test_append_packet),
        cmocka_unit_test(test_append_long_packets),
        cmocka_unit_test(test_append_packet_to_no_list),
        cmocka_unit_test(test_probe),
        cmocka_unit_test(test_probe_errors),
        cmocka_unit_test(test_probe_of_a_short_header),
        cmocka_unit_test(test_every_order),
        cmocka_unit_test(test_useless_packets),
        cmocka_unit_test(test_packets_with_other_steps),
        cmocka_unit_test(test_repair_packets),
        cmocka_unit_test(test_repair_packets_of_another_picture),
        cmocka_unit_test(test_packets_without_splats),
        cmocka_unit_test(test_changed_packets),
        cmocka_unit_test(test_settings),
        cmocka_unit_test(test_pieces),
        cmocka_unit_test(test_mixed_input),
        cmocka_unit_test(test_missing_arguments),
    };
    return cmocka_run_group_tests(tests, open_packets, close_packets);
}
