#include "decode/packet_split.h"

#include <stdlib.h>

#include "decode/format_result.h"
#include "decode/packet_balance.h"
#include "decode/packet_parts.h"
#include "format/container.h"
#include "format/format.h"
#include "format/packet.h"
#include "format/repair.h"

/* A list that is being written. */
typedef struct packet_list {
    uint8_t *bytes;
    size_t size;
    gsf_bytes packets[GSF_MAX_PACKETS];
} packet_list;

/* Room for the next packet, behind the field with its size. */
static uint8_t *append_room(packet_list *list, size_t size) {
    gsf_put_packet_size(list->bytes + list->size, size);
    list->size += gsf_packet_size_field(size) + size;
    return list->bytes + list->size - size;
}

static gsf_result append_packets(gscl_packet_split *s, packet_list *list) {
    gsf_result result = GSF_OK;
    for (uint32_t i = 0; i < s->target.count && result == GSF_OK; i++) {
        size_t written;
        uint8_t *packet = append_room(list, s->sizes[i]);
        gscl_packet_split_take(s, i);
        result = gsf_write(&s->part, packet, s->sizes[i], &written, s->scratch);
        list->packets[i] = (gsf_bytes){packet, s->sizes[i]};
    }
    return result;
}

/* Gives the packets of a list an identity that depends on all of them. */
static void set_identity(packet_list *list, uint32_t packets) {
    const uint8_t hash = (uint8_t)(1 + gsf_crc16(list->bytes, list->size) % 255);
    for (uint32_t i = 0; i < packets; i++)
        gsf_put_packet_frame(list->bytes + (list->packets[i].data - list->bytes),
                             list->packets[i].size - GSF_PACKET_FRAME, hash == GSF_NO_IDENTITY ? 1 : hash);
}

static void append_repairs(const gscl_packet_split *s, packet_list *list) {
    const size_t longest = s->sizes[gscl_packet_split_fullest(s)];
    for (uint32_t i = 0; i < s->target.repairs; i++)
        gsf_write_repair(list->packets, s->target.count, longest, s->target.count + i,
                         append_room(list, longest - 1 + GSF_REPAIR_FRAME));
}

static gscl_result write_list(gscl_packet_split *s, uint8_t **bytes, size_t *size) {
    const size_t repair = s->sizes[gscl_packet_split_fullest(s)] - 1 + GSF_REPAIR_FRAME;
    size_t all = GSF_PACKET_LIST_START + s->target.repairs * (gsf_packet_size_field(repair) + repair);
    for (uint32_t i = 0; i < s->target.count; i++)
        all += gsf_packet_size_field(s->sizes[i]) + s->sizes[i];
    packet_list list = {.bytes = malloc(all), .size = GSF_PACKET_LIST_START};
    if (!list.bytes)
        return GSCL_ERROR_OUT_OF_MEMORY;
    gsf_put_packet_list_start(list.bytes);
    const gsf_result result = append_packets(s, &list);
    if (result != GSF_OK) {
        free(list.bytes);
        return gscl_result_of_format(result);
    }
    if (s->target.identity == 0)
        set_identity(&list, s->target.count);
    append_repairs(s, &list);
    *bytes = list.bytes;
    *size = list.size;
    return GSCL_OK;
}

size_t gscl_packets_bytes(const uint8_t *list, size_t size) {
    size_t all = 0, position = 0;
    for (gsf_bytes packet; gsf_next_packet(list, size, &position, &packet);)
        all += packet.size;
    return all;
}

gscl_result gscl_packets_size(const gsf_coded_image *file, uint32_t packets, size_t *size) {
    gsf_coded_image copy = *file; /* whose splats stay as they are */
    gscl_packet_split s = {.file = &copy, .target = {.count = packets}};
    gscl_result result = gscl_packet_split_begin(&s);
    if (result == GSCL_OK)
        result = gscl_packet_split_divide(&s);
    *size = 0;
    for (uint32_t i = 0; i < packets && result == GSCL_OK; i++)
        *size += s.sizes[i];
    gscl_packet_split_free(&s);
    return result;
}

gscl_result gscl_packets_write(gsf_coded_image *file, const gscl_packet_target *target, uint8_t **list, size_t *size) {
    gscl_packet_split s = {.file = file, .target = *target};
    gscl_result result = gscl_packet_split_begin(&s);
    if (result == GSCL_OK) {
        gsf_remove_repeated(file);
        result = gscl_packet_split_divide(&s);
    }
    if (result == GSCL_OK)
        result = gscl_packet_balance(&s);
    if (result == GSCL_OK)
        result = write_list(&s, list, size);
    if (result == GSCL_OK)
        gsf_sort(file, s.scratch); /* splats have moved */
    gscl_packet_split_free(&s);
    return result;
}
