#include "synthetic_packets.h"

#include <stdlib.h>
#include <string.h>

#include "format/classes.h"
#include "format/packet.h"
#include "format/repair.h"

synthetic_scene *synthetic_divisible_scene(int number, uint32_t width, uint32_t height, uint32_t splats) {
    gsf_header header = synthetic_header(number, GSF_CODING_SCALAR);
    header.width = width;
    header.height = height;
    header.splat_count = splats;
    header.enhancement_layers = 0;
    synthetic_scene *scene = synthetic_scene_new(&header);
    if (!scene)
        return NULL;
    synthetic_background(&scene->image);
    scene->image.has_mean_background = splats > 0 && number % 2;
    scene->image.steps = (gsf_steps){6, 8, header.has_rotation ? 4 : 0, 5, 3, 4, header.has_opacity ? 3 : 0, 10};
    for (uint32_t i = 0; i < splats; i++)
        synthetic_splat(&scene->image, &scene->image.splats[i], synthetic_random(14),
                        header.has_anisotropy ? synthetic_random(8) : 0);
    return scene;
}

static uint32_t first_packet(const gsf_coded_image *image, uint32_t splat, uint32_t count) {
    uint32_t packet = 0;
    while (packet < count && !gsf_packet_may_hold(image, splat, count, packet))
        packet++;
    return packet;
}

/* Writes one packet; data is NULL when that fails. */
static gsf_bytes write_packet(const gsf_coded_image *image, uint32_t count, uint32_t number, uint8_t identity) {
    synthetic_scene *part = synthetic_scene_new(&image->header);
    uint8_t *bytes = NULL;
    size_t size = 0;
    if (!part)
        return (gsf_bytes){NULL, 0};
    gsf_coded_image *to = &part->image;
    to->header.splat_count = 0;
    for (uint32_t i = 0; i < image->header.splat_count; i++)
        if (first_packet(image, i, count) == number)
            to->splats[to->header.splat_count++] = image->splats[i];
    to->header.packets = (uint16_t)count;
    to->header.packet = (uint8_t)number;
    to->identity = identity;
    to->steps = image->steps;
    to->has_mean_background = image->has_mean_background;
    memcpy(to->background, image->background, sizeof to->background);
    if (synthetic_scene_write(part, &bytes, &size) != GSF_OK) {
        free(bytes);
        bytes = NULL;
    }
    synthetic_scene_free(part);
    return (gsf_bytes){bytes, size};
}

static gsf_bytes write_repair(const synthetic_packets *p, uint32_t number) {
    size_t longest = 0;
    for (uint32_t i = 0; i < p->count; i++)
        longest = p->packets[i].size > longest ? p->packets[i].size : longest;
    uint8_t *bytes = malloc(longest - 1 + GSF_REPAIR_FRAME);
    if (bytes)
        gsf_write_repair(p->packets, p->count, longest, number, bytes);
    return (gsf_bytes){bytes, longest - 1 + GSF_REPAIR_FRAME};
}

bool synthetic_packets_write(const gsf_coded_image *image, uint32_t count, uint32_t repairs, uint8_t identity,
                             synthetic_packets *p) {
    bool written = true;
    *p = (synthetic_packets){.count = count, .repairs = repairs};
    for (uint32_t i = 0; i < count + repairs && written; i++) {
        p->packets[i] = i < count ? write_packet(image, count, i, identity) : write_repair(p, i);
        written = p->packets[i].data != NULL;
    }
    return written;
}

void synthetic_packets_free(synthetic_packets *p) {
    for (uint32_t i = 0; i < p->count + p->repairs; i++)
        free((void *)p->packets[i].data);
}

uint8_t *synthetic_list(const synthetic_packets *p, const uint32_t *numbers, uint32_t count, size_t *size) {
    *size = GSF_PACKET_LIST_START;
    for (uint32_t i = 0; i < count; i++)
        *size += gsf_packet_size_field(p->packets[numbers[i]].size) + p->packets[numbers[i]].size;
    uint8_t *list = malloc(*size), *at = list + GSF_PACKET_LIST_START;
    if (!list)
        return NULL;
    gsf_put_packet_list_start(list);
    for (uint32_t i = 0; i < count; i++) {
        const gsf_bytes packet = p->packets[numbers[i]];
        gsf_put_packet_size(at, packet.size);
        at += gsf_packet_size_field(packet.size);
        memcpy(at, packet.data, packet.size);
        at += packet.size;
    }
    return list;
}
