#include <stdbool.h>
#include <string.h>

#include "coded_memory.h"
#include "format/coder.h"
#include "format/container.h"
#include "format/packet.h"
#include "format/payload.h"
#include "format/repair.h"
#include "mutator.h"

#define MAX_PACKETS 24u /* of a list that is taken apart here */
#define ROOM 4096u      /* bytes of a packet */

typedef struct packet_copy {
    uint8_t bytes[ROOM];
    size_t size;
} packet_copy;

static packet_copy packets[MAX_PACKETS + 1];
static uint32_t count;

/* Takes a list apart. */
static void take(const uint8_t *data, size_t size) {
    gsf_bytes packet;
    size_t position = 0;
    count = 0;
    while (count < MAX_PACKETS && gsf_next_packet(data, size, &position, &packet) && packet.size <= ROOM) {
        memcpy(packets[count].bytes, packet.data, packet.size);
        packets[count++].size = packet.size;
    }
}

/* Puts it together again, as far as it fits. */
static size_t put(uint8_t *data, size_t max_size) {
    size_t size = GSF_PACKET_LIST_START;
    if (max_size < size)
        return 0;
    gsf_put_packet_list_start(data);
    for (uint32_t i = 0; i < count; i++) {
        const size_t field = gsf_packet_size_field(packets[i].size);
        if (field + packets[i].size > max_size - size)
            break;
        gsf_put_packet_size(data + size, packets[i].size);
        memcpy(data + size + field, packets[i].bytes, packets[i].size);
        size += field + packets[i].size;
    }
    return size;
}

static bool is_repair(const packet_copy *packet) {
    uint8_t identity;
    uint32_t number;
    return gsf_open_repair((gsf_bytes){packet->bytes, packet->size}, &identity, &number);
}

/* Changes the picture of a packet, whose check then matches. */
static void change_picture(packet_copy *packet) {
    if (packet->size <= GSF_PACKET_FRAME)
        return;
    uint8_t *picture = packet->bytes + 1;
    const size_t size = LLVMFuzzerMutate(picture, packet->size - GSF_PACKET_FRAME, ROOM - GSF_PACKET_FRAME);
    packet->size = gsf_put_packet_frame(packet->bytes, fuzz_picture_end(picture, size, true), packet->bytes[0]);
}

/* Changes a repair packet, whose check then matches. */
static void change_repair(packet_copy *packet) {
    const size_t size = LLVMFuzzerMutate(packet->bytes, packet->size - GSF_CHECK_SIZE, ROOM - GSF_CHECK_SIZE);
    gsf_put_check(packet->bytes, size, GSF_REPAIR_MASK);
    packet->size = size + GSF_CHECK_SIZE;
}

static void change_packet(packet_copy *packet) {
    if (fuzz_pick(12) == 0)
        packet->size = LLVMFuzzerMutate(packet->bytes, packet->size, ROOM);
    else if (is_repair(packet))
        change_repair(packet);
    else
        change_picture(packet);
}

/* Gives a packet one of a few identities. */
static void change_identity(packet_copy *packet) {
    gsf_header header;
    uint8_t identity;
    if (gsf_read_packet_header((gsf_bytes){packet->bytes, packet->size}, &identity, &header) == GSF_OK)
        packet->size = gsf_put_packet_frame(packet->bytes, packet->size - GSF_PACKET_FRAME, (uint8_t)fuzz_pick(3));
}

static void move_packets(void) {
    const uint32_t i = fuzz_pick(count), j = fuzz_pick(count);
    packets[MAX_PACKETS] = packets[i];
    switch (fuzz_pick(3)) {
    case 0: /* two change places */
        packets[i] = packets[j];
        packets[j] = packets[MAX_PACKETS];
        break;
    case 1: /* one comes twice */
        if (count < MAX_PACKETS)
            packets[count++] = packets[MAX_PACKETS];
        break;
    default: /* one is lost */
        packets[i] = packets[--count];
    }
}

/* Appends a repair packet of the list's picture, where no packet is lost. */
static void append_repair(uint8_t *data, size_t max_size) {
    gsf_bytes sorted[GSF_MAX_PACKETS];
    uint8_t identity;
    size_t longest = 0;
    const size_t size = put(data, max_size);
    const uint32_t all = gsf_list_packets(data, size, sorted, &identity);
    bool complete = all > 0 && all < GSF_MAX_PACKETS && count < MAX_PACKETS;
    for (uint32_t i = 0; i < all; i++) {
        complete = complete && sorted[i].data;
        longest = complete && sorted[i].size > longest ? sorted[i].size : longest;
    }
    if (!complete || longest + GSF_REPAIR_FRAME > ROOM)
        return;
    gsf_write_repair(sorted, all, longest, all + fuzz_pick(GSF_MAX_PACKETS - all), packets[count].bytes);
    packets[count++].size = longest - 1 + GSF_REPAIR_FRAME;
}

static size_t mutate_list(uint8_t *data, size_t size, size_t max_size) {
    take(data, size);
    if (count == 0)
        return LLVMFuzzerMutate(data, size, max_size);
    const uint32_t kind = fuzz_pick(8);
    if (kind < 4)
        change_packet(&packets[fuzz_pick(count)]);
    else if (kind == 4)
        change_identity(&packets[fuzz_pick(count)]);
    else if (kind == 5)
        append_repair(data, max_size);
    else
        move_packets();
    return put(data, max_size);
}

size_t fuzz_mutate_packets(uint8_t *data, size_t size, size_t max_size, unsigned seed) {
    fuzz_begin_picks(seed);
    if (gsf_is_packet_list(data, size) && fuzz_pick(16) > 0)
        return mutate_list(data, size, max_size);
    return LLVMFuzzerMutate(data, size, max_size);
}
