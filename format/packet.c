#include "format/packet.h"

#include <string.h>

#include "format/check.h"
#include "format/container.h"
#include "format/header.h"
#include "format/order.h"
#include "format/payload.h"
#include "format/picture.h"

static const uint8_t LIST_MAGIC[GSF_PACKET_LIST_START] = {0xC7, 'g', 's', 'p'};

/* ---- One packet ---- */

gsf_result gsf_open_packet(gsf_bytes packet, uint8_t *identity, gsf_bytes *picture) {
    if (packet.size <= GSF_PACKET_FRAME)
        return GSF_TRUNCATED;
    if (packet.data[0] == GSF_NO_IDENTITY)
        return GSF_NOT_GSCL;
    if (!gsf_has_check(packet.data, packet.size, 0))
        return GSF_DAMAGED;
    *identity = packet.data[0];
    *picture = (gsf_bytes){packet.data + 1, packet.size - GSF_PACKET_FRAME};
    return GSF_OK;
}

gsf_result gsf_read_packet_header(gsf_bytes packet, uint8_t *identity, gsf_header *header) {
    gsf_bytes picture;
    gsf_coder coder;
    const gsf_result result = gsf_open_packet(packet, identity, &picture);
    if (result != GSF_OK)
        return result;
    *header = (gsf_header){.packets = 1};
    gsf_coder_read_from(&coder, picture.data, picture.size, NULL);
    gsf_code_fields(&coder, header);
    return gsf_coder_overrun(&coder) ? GSF_CORRUPT : GSF_OK;
}

size_t gsf_put_packet_frame(uint8_t *packet, size_t size, uint8_t identity) {
    packet[0] = identity;
    gsf_put_check(packet, 1 + size, 0);
    return size + GSF_PACKET_FRAME;
}

/* ---- Lists ---- */

bool gsf_is_packet_list(const uint8_t *bytes, size_t size) {
    return GSF_HAS_PACKETS && size >= sizeof LIST_MAGIC && memcmp(bytes, LIST_MAGIC, sizeof LIST_MAGIC) == 0;
}

void gsf_put_packet_list_start(uint8_t *list) {
    memcpy(list, LIST_MAGIC, sizeof LIST_MAGIC);
}

size_t gsf_packet_size_field(size_t packet_size) {
    return gsf_varint_size(packet_size);
}

void gsf_put_packet_size(uint8_t *list, size_t packet_size) {
    gsf_put_varint(list, packet_size);
}

bool gsf_next_packet(const uint8_t *list, size_t size, size_t *position, gsf_bytes *packet) {
    const size_t start = *position > 0 ? *position : sizeof LIST_MAGIC;
    uint32_t packet_size;
    const size_t field = start < size ? gsf_get_varint(list + start, size - start, &packet_size) : 0;
    if (field == 0 || packet_size > size - start - field)
        return false;
    *packet = (gsf_bytes){list + start + field, packet_size};
    *position = start + field + packet_size;
    return true;
}

/* Whether the headers are of packets of one picture. */
static bool is_same_picture(const gsf_header *a, const gsf_header *b) {
    return a->packets == b->packets && a->blend == b->blend && a->layout == b->layout &&
           a->high_bit_depth == b->high_bit_depth && a->has_chroma == b->has_chroma && a->has_alpha == b->has_alpha &&
           a->has_opacity == b->has_opacity && a->has_texture == b->has_texture && a->has_rotation == b->has_rotation &&
           a->has_anisotropy == b->has_anisotropy && a->width == b->width && a->height == b->height;
}

/* The picture of a list, and what has been read of it. */
typedef struct list_reader {
    gsf_header header; /* of the packet that says which picture it is; packets is 0 before it */
    uint8_t identity;
    bool has_number[GSF_MAX_PACKETS];
    bool has_first; /* a packet has been read: steps and background are known */
} list_reader;

/* Whether this is a packet of the picture.  The first one with a header says which picture that is. */
static bool is_of_picture(list_reader *r, gsf_bytes packet, gsf_header *header) {
    uint8_t identity;
    if (gsf_read_packet_header(packet, &identity, header) != GSF_OK)
        return false;
    if (r->header.packets == 0) {
        r->header = *header;
        r->identity = identity;
    }
    return identity == r->identity && is_same_picture(header, &r->header);
}

uint32_t gsf_list_packets(const uint8_t *list, size_t size, gsf_bytes packets[GSF_MAX_PACKETS], uint8_t *identity) {
    list_reader r = {.has_first = false};
    gsf_header own;
    gsf_bytes packet;
    size_t position = 0;
    for (uint32_t i = 0; i < GSF_MAX_PACKETS; i++)
        packets[i] = (gsf_bytes){NULL, 0};
    while (gsf_next_packet(list, size, &position, &packet))
        if (is_of_picture(&r, packet, &own) && !packets[own.packet].data)
            packets[own.packet] = packet;
    *identity = r.identity;
    return r.header.packets;
}

gsf_result gsf_read_list_header(const uint8_t *list, size_t size, gsf_header *header) {
    list_reader r = {.has_first = false};
    gsf_header own;
    gsf_bytes packet;
    size_t position = 0;
    uint32_t splats = 0;
    while (gsf_next_packet(list, size, &position, &packet))
        if (is_of_picture(&r, packet, &own)) {
            const uint32_t room = GSF_MAX_SPLATS - splats;
            splats += own.splat_count < room ? own.splat_count : room;
        }
    if (r.header.packets == 0)
        return position == 0 ? GSF_TRUNCATED : GSF_DAMAGED;
    *header = r.header;
    header->packet = 0;
    header->splat_count = splats;
    return GSF_OK;
}

/* Whether steps and background of a packet are those of the packets before it.  They count where there are splats only. */
static bool agrees(const gsf_coded_image *part, const gsf_coded_image *image) {
    if (part->header.splat_count == 0 || image->header.splat_count == 0)
        return true;
    return memcmp(&part->steps, &image->steps, sizeof part->steps) == 0 &&
           part->has_mean_background == image->has_mean_background &&
           memcmp(part->background, image->background, sizeof part->background) == 0;
}

/* Reads a packet into `part`, whose arrays are in place. */
static bool read_part(gsf_bytes packet, gsf_coded_image *part, void *scratch) {
    uint8_t identity;
    gsf_bytes picture;
    memset(&part->steps, 0, sizeof part->steps);
    memset(part->background, 0, sizeof part->background);
    part->header = (gsf_header){.packets = 1};
    part->has_mean_background = false;
    return gsf_open_packet(packet, &identity, &picture) == GSF_OK && gsf_read_picture(part, picture, scratch) == GSF_OK;
}

/* Adds the splats of a part, which stand behind those of `image`, where it agrees with the others and the limits allow. */
static bool add_part(list_reader *r, const gsf_coded_image *part, gsf_coded_image *image) {
    const uint32_t before = image->header.splat_count;
    if (!agrees(part, image))
        return false;
    image->header.splat_count = before + part->header.splat_count;
    if (!r->has_first || (before == 0 && part->header.splat_count > 0)) {
        image->steps = part->steps;
        image->has_mean_background = part->has_mean_background;
        memcpy(image->background, part->background, sizeof part->background);
    }
    if (gsf_work_is_bounded(image))
        return true;
    image->header.splat_count = before;
    return false;
}

/* Takes a packet's splats.  The bits of one that is not taken do not count. */
static void take_packet(list_reader *r, const gsf_header *header, gsf_bytes packet, gsf_coded_image *image,
                        void *scratch) {
    gsf_coded_image part = *image;
    uint64_t bits[GSF_STREAM_COUNT] = {0};
    const uint32_t before = image->header.splat_count;
    if (r->has_number[header->packet])
        return;
    r->has_number[header->packet] = true; /* also where it is not valid, which bounds the work */
    if (header->splat_count > GSF_MAX_SPLATS - before)
        return;
    part.stream_bits256 = GSF_STREAM_BITS(image) ? bits : NULL;
    part.splats = image->splats + before;
    if (!read_part(packet, &part, scratch) || !add_part(r, &part, image))
        return;
    r->has_first = true;
    image->packets_read++;
    for (unsigned i = 0; GSF_STREAM_BITS(image) && i < GSF_STREAM_COUNT; i++)
        image->stream_bits256[i] += bits[i];
    if (GSF_STREAM_BITS(image))
        image->stream_bits256[GSF_STREAM_CONTAINER] -= (uint64_t)(packet.size - GSF_PACKET_FRAME) * 8 * 256;
}

/* Sets what the header of the first packet says of the picture. */
static void set_kind(const list_reader *r, gsf_coded_image *image) {
    const uint32_t count = image->header.splat_count;
    image->header = r->header;
    image->header.packets = image->header.packet = 0;
    image->header.splat_count = count;
}

void gsf_remove_repeated(gsf_coded_image *image) {
    const uint32_t count = image->header.splat_count;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++)
        if (kept == 0 || memcmp(&image->splats[i], &image->splats[kept - 1], sizeof image->splats[i]) != 0)
            image->splats[kept++] = image->splats[i];
    image->header.splat_count = kept;
}

gsf_result gsf_read_list(const uint8_t *list, size_t size, gsf_coded_image *image, void *scratch) {
    list_reader r = {.has_first = false};
    gsf_header header;
    gsf_bytes packet;
    size_t position = 0;
    image->header.splat_count = 0;
    image->packets_read = 0;
    while (gsf_next_packet(list, size, &position, &packet)) {
        if (!is_of_picture(&r, packet, &header))
            continue;
        set_kind(&r, image);
        take_packet(&r, &header, packet, image, scratch);
    }
    if (!r.has_first)
        return position == 0 ? GSF_TRUNCATED : GSF_DAMAGED;
    gsf_sort_splats(image, (gsf_workspace *)scratch + 1);
    gsf_remove_repeated(image);
    return GSF_OK;
}
