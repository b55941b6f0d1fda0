/* Repair packets in format/: which lost packets they make up for. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "format/container.h"
#include "format/packet.h"
#include "format/repair.h"
#include "synthetic_packets.h"

/* Packets of a scene, of different sizes. */
static synthetic_packets divided(int number, uint32_t count, uint32_t repairs, uint8_t identity) {
    synthetic_packets packets;
    synthetic_scene *scene = synthetic_divisible_scene(number, 200, 100, 60 + count);
    assert_non_null(scene);
    assert_true(synthetic_packets_write(&scene->image, count, repairs, identity, &packets));
    synthetic_scene_free(scene);
    return packets;
}

/* What the packets of these numbers make up for, as a list without its start.  Returns its size. */
static size_t repair(const synthetic_packets *packets, const uint32_t *numbers, uint32_t count, uint8_t **made) {
    size_t size;
    uint8_t *list = synthetic_list(packets, numbers, count, &size);
    assert_non_null(list);
    const size_t room = gsf_repair_size(list, size);
    *made = malloc(room + 1);
    assert_non_null(*made);
    const size_t used = room > 0 ? gsf_repair_list(list, size, *made) : 0;
    assert_true(used <= room);
    free(list);
    return used;
}

/* Of these packets, with repair packets among them, those that are lost become what they were. */
static void check_repaired(const synthetic_packets *packets, const bool *is_lost, bool expected) {
    uint32_t numbers[GSF_MAX_PACKETS], count = 0;
    uint8_t *made;
    for (uint32_t i = packets->count + packets->repairs; i-- > 0;)
        if (!is_lost[i])
            numbers[count++] = i;
    size_t size = repair(packets, numbers, count, &made);
    const uint8_t *at = made;
    for (uint32_t k = 0; k < packets->count && expected; k++) {
        const gsf_bytes *packet = &packets->packets[k];
        if (!is_lost[k])
            continue;
        const size_t field = gsf_packet_size_field(packet->size);
        assert_true(size >= field + packet->size);
        assert_memory_equal(at + field, packet->data, packet->size);
        at += field + packet->size;
        size -= field + packet->size;
    }
    assert_int_equal(size, 0);
    free(made);
}

static void test_every_three_of_seven(void **unused) {
    (void)unused;
    enum { PACKETS = 7, REPAIRS = 3, ALL = PACKETS + REPAIRS };
    synthetic_random_state = 3;
    synthetic_packets packets = divided(2, PACKETS, REPAIRS, 7);
    for (unsigned lost = 0; lost < 1u << ALL; lost++) {
        bool is_lost[GSF_MAX_PACKETS] = {false};
        unsigned splats = 0, all = 0;
        for (unsigned i = 0; i < ALL; i++) {
            is_lost[i] = lost >> i & 1;
            all += is_lost[i];
            splats += is_lost[i] && i < PACKETS;
        }
        if (splats > 0 && splats < PACKETS)
            check_repaired(&packets, is_lost, all <= REPAIRS);
    }
    synthetic_packets_free(&packets);
}

static void test_random_numbers(void **unused) {
    (void)unused;
    synthetic_random_state = 4;
    for (int number = 0; number < 60; number++) {
        const uint32_t count = 2 + synthetic_random(number % 3 == 0 ? 250 : 30);
        const uint32_t most = GSF_MAX_PACKETS - count,
                       repairs = number % 4 == 0 ? most : synthetic_random(most < 20 ? most : 20);
        synthetic_packets packets = divided(number, count, repairs, (uint8_t)number);
        bool is_lost[GSF_MAX_PACKETS] = {false};
        for (uint32_t i = 0, lost = 0; lost < repairs && lost + 1 < count && i < 2000; i++) {
            const uint32_t k = synthetic_random(count);
            lost += !is_lost[k];
            is_lost[k] = true;
        }
        check_repaired(&packets, is_lost, true);
        synthetic_packets_free(&packets);
    }
}

/* Repair packets of another picture give nothing, whatever their number and length. */
static void test_other_pictures(void **unused) {
    (void)unused;
    synthetic_random_state = 6;
    for (int number = 0; number < 200; number++) {
        const uint32_t count = 2 + synthetic_random(10), repairs = 1 + synthetic_random(4);
        synthetic_packets packets = divided(number, count, repairs, 7);
        synthetic_packets others = divided(number, count, repairs, number % 2 ? 7 : 8);
        bool is_lost[GSF_MAX_PACKETS] = {true};
        for (uint32_t i = count; i < count + repairs; i++) {
            const gsf_bytes own = packets.packets[i];
            packets.packets[i] = others.packets[i];
            others.packets[i] = own;
        }
        check_repaired(&packets, is_lost, false);
        synthetic_packets_free(&packets);
        synthetic_packets_free(&others);
    }
}

/* The end of a packet is found behind zeros, and where its last bytes are 0. */
static void test_packets_that_end_with_zeros(void **unused) {
    (void)unused;
    unsigned found = 0;
    synthetic_random_state = 8;
    for (int number = 0; number < 1500; number++) {
        synthetic_packets packets = divided(4 + number % 8, 4, 1, (uint8_t)(number % 199));
        for (uint32_t k = 0; k < 4; k++) {
            bool is_lost[GSF_MAX_PACKETS] = {false};
            const gsf_bytes packet = packets.packets[k];
            if (packet.data[packet.size - 1] != 0)
                continue;
            is_lost[k] = true;
            check_repaired(&packets, is_lost, true);
            found++;
        }
        synthetic_packets_free(&packets);
    }
    assert_true(found > 10);
}

/* A copy of a repair packet with this identity and number, and some bytes more, whose check matches. */
static gsf_bytes changed_repair(gsf_bytes repair, uint8_t identity, uint8_t number, size_t more) {
    const size_t size = repair.size + more;
    uint8_t *copy = calloc(size, 1);
    assert_non_null(copy);
    memcpy(copy, repair.data, repair.size - 2);
    copy[0] = identity;
    copy[1] = number;
    const uint16_t check = gsf_crc16(copy, size - 2) ^ 0xFFFF;
    copy[size - 2] = (uint8_t)(check >> 8);
    copy[size - 1] = (uint8_t)check;
    return (gsf_bytes){copy, size};
}

/* Repair packets that are of no use among those that are: packets 0 and 1 of four are lost. */
static void test_useless_repairs(void **unused) {
    (void)unused;
    static const uint32_t order[] = {4, 6, 2, 3, 5};
    static const uint8_t identities[] = {8, 7, 7, 7}, numbers[] = {9, 2, 4, 9};
    synthetic_random_state = 12;
    for (int kind = 0; kind < 4; kind++) {
        synthetic_packets packets = divided(2, 4, 3, 7);
        free((void *)packets.packets[6].data);
        packets.packets[6] = changed_repair(packets.packets[4], identities[kind], numbers[kind], kind == 3);
        uint8_t *made;
        const size_t size = repair(&packets, order, 5, &made);
        const uint8_t *at = made;
        for (uint32_t k = 0; k < 2; k++) {
            at += gsf_packet_size_field(packets.packets[k].size);
            assert_true(at + packets.packets[k].size <= made + size);
            assert_memory_equal(at, packets.packets[k].data, packets.packets[k].size);
            at += packets.packets[k].size;
        }
        assert_ptr_equal(at, made + size);
        free(made);
        synthetic_packets_free(&packets);
    }
}

static void test_damaged_repairs(void **unused) {
    (void)unused;
    uint8_t identity;
    uint32_t number;
    synthetic_random_state = 10;
    synthetic_packets packets = divided(2, 3, 2, 7);
    const gsf_bytes last = packets.packets[4];
    assert_true(gsf_open_repair(last, &identity, &number));
    assert_int_equal(identity, 7);
    assert_int_equal(number, 4);
    assert_false(gsf_open_repair(packets.packets[0], &identity, &number));
    for (size_t at = 0; at < last.size; at++) {
        ((uint8_t *)last.data)[at] ^= 8;
        assert_false(gsf_open_repair(last, &identity, &number));
        ((uint8_t *)last.data)[at] ^= 8;
    }
    for (size_t size = 0; size < last.size; size++)
        assert_false(gsf_open_repair((gsf_bytes){last.data, size}, &identity, &number));
    synthetic_packets_free(&packets);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_three_of_seven), cmocka_unit_test(test_random_numbers),
        cmocka_unit_test(test_other_pictures),       cmocka_unit_test(test_packets_that_end_with_zeros),
        cmocka_unit_test(test_useless_repairs),      cmocka_unit_test(test_damaged_repairs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
