/* Reads hostile lists of packets, where the input begins as one: what is read can be written as a file, which reads back equal,
 * and what repair packets give are packets.  Other input describes an image that is divided into packets: each of them reads
 * back equal, some of them in any order give what they hold, each splat once, and repair packets give the others. */
#include <string.h>

#include "coded_scene.h"
#include "format/check.h"
#include "format/classes.h"
#include "format/packet.h"
#include "format/repair.h"
#include "mutator.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define USUAL_SPLATS 150u /* images with more take most of the time of fuzzing, and are read by a sample */
#define MAX_REPAIRS 8
#define REPAIR_ROOM (FUZZ_MAX_FILE / 2)

static fuzz_memory memory, memory_again;
static uint8_t file[FUZZ_MAX_FILE], list[FUZZ_MAX_FILE];

/* Whether a check that takes long is made of this input: of all in replay.c, of one in four when fuzzing. */
static bool is_sampled(const uint8_t *bytes, size_t size) {
#ifdef FUZZ_SAMPLE
    return bytes[size - 1] % 4 == 0;
#else
    return size > 0 && bytes != NULL;
#endif
}

/* ---- Reading --------------------------------------------------------------------------------- */

/* Writes what was read from a list as a file, and reads it back. */
static void check_rewriting(gsf_coded_image *image) {
    gsf_coded_image again;
    gsf_header header;
    size_t size = 0;
    image->stream_bits256 = NULL;
    fuzz_require(gsf_write_bound(image) <= FUZZ_MAX_FILE, "a file is larger than was planned");
    fuzz_require(gsf_write(image, file, sizeof file, &size, fuzz_scratch(&image->header)) == GSF_OK,
                 "what was read from packets cannot be written");
    fuzz_require(gsf_read_header(file, size, false, &header) == GSF_OK, "the header of a written file cannot be read");
    fuzz_require(fuzz_create(&again, &memory_again, &header), "a file has more splats than its packets");
    fuzz_require(gsf_read(file, size, &again, fuzz_scratch(&header)) == GSF_OK, "a written file cannot be read");
    fuzz_require(again.header.splat_count == image->header.splat_count &&
                     memcmp(again.splats, image->splats, again.header.splat_count * sizeof *again.splats) == 0,
                 "the splats of packets are not in the stored order");
}

static void check_distinct(const gsf_coded_image *image) {
    for (uint32_t i = 1; i < image->header.splat_count; i++)
        fuzz_require(memcmp(&image->splats[i - 1], &image->splats[i], sizeof *image->splats) != 0,
                     "a splat is there twice");
}

/* Reads a list into `memory`.  Returns whether it can be read and is not too large. */
static bool read_list(const uint8_t *bytes, size_t size, uint32_t max_splats, gsf_coded_image *image) {
    gsf_header header;
    if (gsf_read_header(bytes, size, false, &header) != GSF_OK || header.splat_count > max_splats ||
        !fuzz_create(image, &memory, &header))
        return false;
    const gsf_result result = gsf_read(bytes, size, image, fuzz_scratch(&header));
    fuzz_require(result == GSF_OK || result == GSF_DAMAGED, "a list with a header has another result");
    if (result != GSF_OK)
        return false;
    fuzz_require(image->header.splat_count <= header.splat_count && image->packets_read > 0,
                 "a list has more splats than its packets");
    check_distinct(image);
    return true;
}

/* Appends to a copy of a list in `list` what its repair packets make up for.  Returns the size; 0: nothing. */
static size_t repair_list(const uint8_t *bytes, size_t size) {
    const size_t room = gsf_repair_size(bytes, size);
    size_t end = 0;
    for (gsf_bytes packet; gsf_next_packet(bytes, size, &end, &packet);)
        continue;
    if (room == 0 || end + room > sizeof list)
        return 0;
    memcpy(list, bytes, end);
    const size_t made = gsf_repair_list(bytes, size, list + end);
    fuzz_require(made <= room, "computed packets are larger than their room");
    size_t position = end;
    uint8_t identity;
    gsf_bytes picture;
    for (gsf_bytes packet; gsf_next_packet(list, end + made, &position, &packet);)
        fuzz_require(gsf_open_packet(packet, &identity, &picture) == GSF_OK, "a computed packet is none");
    fuzz_require(made == 0 || position == end + made, "computed packets do not fill their list");
    return end + made;
}

static void read_hostile_list(const uint8_t *data, size_t size) {
    gsf_coded_image image;
    const uint32_t most = size > 0 && data[size - 1] % 16 > 0 ? USUAL_SPLATS : FUZZ_MAX_SPLATS;
    if (read_list(data, size, most, &image) && is_sampled(data, size))
        check_rewriting(&image);
    const size_t repaired = repair_list(data, size);
    if (repaired > 0)
        (void)read_list(list, repaired, most, &image);
}

/* ---- Writing --------------------------------------------------------------------------------- */

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

/* Few in most inputs, because many take most of the time of fuzzing. */
static uint32_t read_count(byte_source *source) {
    const int choice = source_within(source, 0, 63);
    return choice == 0 ? (uint32_t)source_within(source, 1, GSF_MAX_PACKETS) : 1u + (uint32_t)choice % 9;
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
    fuzz_require(read_list(file, size, FUZZ_MAX_SPLATS, &found), "packets cannot be read");
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
    const size_t size = list_packets(d, 0, true), repaired = repair_list(file, size);
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

static void write_divided_image(const uint8_t *data, size_t size) {
    static division d;
    byte_source source = {data, size};
    gsf_coded_image *image = &d.scene.image;
    d.count = read_count(&source);
    memset(d.is_lost, 0, sizeof d.is_lost);
    scene_read(&d.scene, &memory, &source);
    if (image->header.coding != GSF_CODING_SCALAR || image->header.enhancement_layers > 0 ||
        !gsf_work_is_bounded(image))
        return;
    gsf_sort(image, fuzz_scratch(&image->header)); /* zeroes what is not in use */
    divide(&d, &source);
    write_packets(&d, &source);
    lose_packets(&d, &source);
    check_union(&d, list_packets(&d, (uint32_t)source_within(&source, 0, (int)d.count - 1), false));
    memset(d.is_lost, 0, sizeof d.is_lost);
    check_repair(&d, &source);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    if (gsf_is_packet_list(data, size))
        read_hostile_list(data, size);
    else
        write_divided_image(data, size);
    return 0;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed) {
    return fuzz_mutate_packets(data, size, max_size, seed);
}
