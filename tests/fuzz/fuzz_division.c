/* An input describes an image that is divided into packets: each of them reads back equal, some of them in any order give what
 * they hold, each splat once, and repair packets give the others. */
#include <string.h>

#include "coded_scene.h"
#include "format/check.h"
#include "format/classes.h"
#include "format/packet.h"
#include "format/repair.h"
#include "packet_list.h"
#include "sample.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define MAX_REPAIRS 8
#define USUAL_PACKETS 9u /* of a scene */
#define REPAIR_ROOM (FUZZ_MAX_FILE / 2)

static fuzz_memory memory, memory_again;
static uint8_t file[FUZZ_MAX_FILE], list[FUZZ_MAX_FILE];

/* A scene that is divided into packets. */
typedef struct division {
    coded_scene scene;
    uint32_t count;                      /* packets */
    uint8_t packet_of[SCENE_MAX_SPLATS]; /* of each splat; several where it is everywhere */
    bool is_everywhere;                  /* whether splats are in all packets that may have them */
    gsf_bytes packets[GSF_MAX_PACKETS];  /* in `bytes` */
    gsf_bytes repairs[MAX_REPAIRS];
    uint32_t repair_count;
    bool is_lost[GSF_MAX_PACKETS];
    size_t longest, used;
    uint8_t bytes[FUZZ_MAX_FILE];
} division;

/* Many are left to a sample of the inputs, because they take most of the time of fuzzing. */
static uint32_t read_count(byte_source *source, bool is_sampled) {
    const int choice = source_within(source, 0, 63);
    const uint32_t count =
        choice == 0 ? (uint32_t)source_within(source, 1, GSF_MAX_PACKETS) : 1u + (uint32_t)choice % 9;
    return is_sampled ? count : 1u + (count - 1u) % USUAL_PACKETS;
}

static bool holds(const division *d, uint32_t splat, uint32_t packet) {
    return d->is_everywhere ? gsf_packet_may_hold(&d->scene.image, splat, d->count, packet)
                            : d->packet_of[splat] == packet;
}

/* Chooses a packet for each splat. */
static void divide(division *d, byte_source *source) {
    d->is_everywhere = source_flag(source);
    for (uint32_t i = 0; i < d->scene.image.header.splat_count; i++) {
        uint32_t packet = (uint32_t)source_within(source, 0, (int)d->count - 1), tried = 0;
        for (; tried < d->count && !gsf_packet_may_hold(&d->scene.image, i, d->count, packet); tried++)
            packet = (packet + 1) % d->count;
        fuzz_require(tried < d->count, "no packet may have a splat");
        d->packet_of[i] = (uint8_t)packet;
    }
}

/* The splats of the packets that are not lost, or those of one packet. */
static void take_splats(const division *d, uint32_t only, gsf_coded_image *image) {
    const gsf_coded_image *whole = &d->scene.image;
    gsf_header largest = whole->header;
    uint32_t count = 0;
    largest.splat_count = FUZZ_MAX_SPLATS;
    fuzz_require(fuzz_create(image, &memory_again, &largest), "a scene has too many splats");
    for (uint32_t k = 0; k < d->count; k++)
        for (uint32_t i = 0; i < whole->header.splat_count && (only < d->count ? k == only : !d->is_lost[k]); i++)
            if (holds(d, i, k) && count < FUZZ_MAX_SPLATS)
                memory_again.splats[count++] = whole->splats[i];
    image->steps = whole->steps;
    image->has_mean_background = whole->has_mean_background;
    memcpy(image->background, whole->background, sizeof image->background);
    image->header.splat_count = count;
}

static gsf_bytes keep(division *d, size_t size) {
    const gsf_bytes kept = {d->bytes + d->used, size};
    d->used += size;
    d->longest = size > d->longest ? size : d->longest;
    return kept;
}

static gsf_bytes write_packet(division *d, uint32_t k, uint8_t identity) {
    gsf_coded_image part;
    size_t size = 0;
    take_splats(d, k, &part);
    part.header.packets = (uint16_t)d->count;
    part.header.packet = (uint8_t)k;
    part.identity = identity;
    part.stream_bits256 = NULL;
    fuzz_require(gsf_write(&part, d->bytes + d->used, REPAIR_ROOM - d->used, &size, fuzz_scratch(&part.header)) ==
                     GSF_OK,
                 "a packet cannot be written");
    fuzz_require(size <= gsf_write_bound(&part), "a packet is larger than its bound");
    return keep(d, size);
}

static void write_repair(division *d, uint32_t i, size_t longest) {
    gsf_write_repair(d->packets, d->count, longest, d->count + i, d->bytes + d->used);
    d->repairs[i] = keep(d, longest - 1 + GSF_REPAIR_FRAME);
}

static size_t append(uint8_t *bytes, size_t at, gsf_bytes packet) {
    gsf_put_packet_size(bytes + at, packet.size);
    at += gsf_packet_size_field(packet.size);
    memcpy(bytes + at, packet.data, packet.size);
    return at + packet.size;
}

/* Puts the packets that are not lost into `file`, beginning with any. */
static size_t list_packets(const division *d, uint32_t first, bool with_repairs) {
    size_t size = GSF_PACKET_LIST_START;
    gsf_put_packet_list_start(file);
    for (uint32_t i = 0; i < d->repair_count && with_repairs; i++)
        size = append(file, size, d->repairs[i]);
    for (uint32_t i = 0; i < d->count; i++)
        if (!d->is_lost[(first + i) % d->count])
            size = append(file, size, d->packets[(first + i) % d->count]);
    return size;
}

/* What the packets that are there give. */
static void check_union(const division *d, size_t size) {
    gsf_coded_image expected, found;
    uint32_t kept = 0;
    take_splats(d, d->count, &expected);
    expected.header.packets = 0;
    if (expected.header.splat_count == FUZZ_MAX_SPLATS || !gsf_work_is_bounded(&expected))
        return;
    gsf_sort(&expected, fuzz_scratch(&expected.header));
    for (uint32_t i = 0; i < expected.header.splat_count; i++)
        if (kept == 0 || memcmp(&expected.splats[i], &expected.splats[kept - 1], sizeof *expected.splats) != 0)
            expected.splats[kept++] = expected.splats[i];
    fuzz_require(packet_list_read(file, size, FUZZ_MAX_SPLATS, &memory, &found), "packets cannot be read");
    fuzz_require(found.header.splat_count == kept &&
                     memcmp(found.splats, expected.splats, kept * sizeof *found.splats) == 0,
                 "packets are read otherwise than they were written");
}

/* Loses packets, as many as there are repair packets at most, but not all, and has them computed. */
static void check_repair(division *d, byte_source *source) {
    uint32_t lost = 0;
    for (uint32_t i = 0; i < d->repair_count && lost + 1 < d->count; i++) {
        const uint32_t k = (uint32_t)source_within(source, 0, (int)d->count - 1);
        lost += !d->is_lost[k];
        d->is_lost[k] = true;
    }
    const size_t size = list_packets(d, 0, true), repaired = packet_list_repair(file, size, list);
    fuzz_require(lost == 0 || repaired > size, "repair packets give nothing");
    size_t position = size;
    for (uint32_t k = 0; k < d->count; k++) {
        gsf_bytes packet;
        if (!d->is_lost[k])
            continue;
        fuzz_require(gsf_next_packet(list, repaired, &position, &packet) && packet.size == d->packets[k].size &&
                         memcmp(packet.data, d->packets[k].data, packet.size) == 0,
                     "a packet is computed otherwise than it was");
    }
}

static void lose_packets(division *d, byte_source *source) {
    const int share = source_within(source, 0, 3); /* of 4 */
    bool any = false;
    for (uint32_t k = 0; k < d->count; k++) {
        d->is_lost[k] = share > 0 && source_within(source, 0, 3) < share && (any || k + 1 < d->count);
        any = any || !d->is_lost[k];
    }
}

static void write_packets(division *d, byte_source *source) {
    const int identity = source_within(source, 0, 255);
    d->used = d->longest = 0;
    for (uint32_t k = 0; k < d->count; k++)
        d->packets[k] = write_packet(d, k, (uint8_t)(identity == GSF_NO_IDENTITY ? 0 : identity));
    const size_t longest = d->longest;
    d->repair_count = (uint32_t)source_within(source, 0, MAX_REPAIRS);
    if (d->repair_count > GSF_MAX_PACKETS - d->count)
        d->repair_count = GSF_MAX_PACKETS - d->count;
    for (uint32_t i = 0; i < d->repair_count; i++)
        write_repair(d, i, longest);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static division d;
    byte_source source = {data, size};
    gsf_coded_image *image = &d.scene.image;
    d.count = read_count(&source, fuzz_is_sampled(data, size, 32));
    memset(d.is_lost, 0, sizeof d.is_lost);
    scene_read(&d.scene, &memory, &source);
    if (image->header.coding != GSF_CODING_SCALAR || image->header.enhancement_layers > 0 ||
        !gsf_work_is_bounded(image))
        return 0;
    gsf_sort(image, fuzz_scratch(&image->header)); /* zeroes what is not in use */
    divide(&d, &source);
    write_packets(&d, &source);
    lose_packets(&d, &source);
    check_union(&d, list_packets(&d, (uint32_t)source_within(&source, 0, (int)d.count - 1), false));
    memset(d.is_lost, 0, sizeof d.is_lost);
    check_repair(&d, &source);
    return 0;
}
