#include "decode/packet_parts.h"

#include <stdlib.h>
#include <string.h>

#include "decode/format_result.h"
#include "format/classes.h"
#include "format/format.h"

void gscl_packet_split_free(gscl_packet_split *s) {
    free(s->packet_of);
    free(s->part.splats);
    free(s->scratch);
}

/* The first packet that may hold a splat; *all: whether every one may. */
static uint32_t first_for(const gscl_packet_split *s, uint32_t splat, bool *all) {
    uint32_t first = s->packets, count = 0;
    for (uint32_t i = 0; i < s->packets; i++) {
        if (!gsf_packet_may_hold(s->file, splat, s->packets, i))
            continue;
        first = count++ == 0 ? i : first;
    }
    *all = count == s->packets;
    return first;
}

void gscl_packet_split_assign(gscl_packet_split *s) {
    uint32_t next = 0;
    bool all;
    for (uint32_t i = 0; i < s->file->header.splat_count; i++) {
        const uint32_t packet = first_for(s, i, &all);
        s->packet_of[i] = (uint16_t)(all ? next++ % s->packets : packet);
    }
}

gscl_result gscl_packet_split_begin(gscl_packet_split *s, const gsf_coded_image *file) {
    const size_t count = file->header.splat_count;
    gsf_header largest = file->header;
    s->packet_of = malloc((count + 1) * sizeof *s->packet_of);
    s->part.splats = malloc((count + 1) * sizeof *s->part.splats);
    s->scratch = malloc(gsf_scratch_size(&largest) + 8);
    return s->packet_of && s->part.splats && s->scratch ? GSCL_OK : GSCL_ERROR_OUT_OF_MEMORY;
}

void gscl_packet_split_take(gscl_packet_split *s, uint32_t packet) {
    gsf_splat *splats = s->part.splats;
    uint32_t count = 0;
    for (uint32_t i = 0; i < s->file->header.splat_count; i++)
        if (s->packet_of[i] == packet)
            splats[count++] = s->file->splats[i];
    s->part = *s->file;
    s->part.splats = splats;
    s->part.stream_bits256 = NULL;
    s->part.blocks = NULL;
    s->part.header.splat_count = count;
    s->part.header.packets = (uint16_t)s->packets;
    s->part.header.packet = (uint8_t)packet;
    s->part.identity = s->target.identity;
    gsf_sort(&s->part, s->scratch);
}

gscl_result gscl_packet_split_measure(gscl_packet_split *s, uint32_t packet) {
    gscl_packet_split_take(s, packet);
    return gscl_result_of_format(gsf_size(&s->part, &s->sizes[packet], s->scratch));
}

gscl_result gscl_packet_split_measure_all(gscl_packet_split *s) {
    gscl_result result = GSCL_OK;
    for (uint32_t i = 0; i < s->packets && result == GSCL_OK; i++)
        result = gscl_packet_split_measure(s, i);
    return result;
}

uint32_t gscl_packet_split_fullest(const gscl_packet_split *s) {
    uint32_t best = 0;
    for (uint32_t i = 1; i < s->packets; i++)
        best = s->sizes[i] > s->sizes[best] ? i : best;
    return best;
}
