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

/* The first packet that may hold a splat. */
static uint32_t first_for(const gsf_packet_choice *choice) {
    uint32_t packet = 0;
    while (!gsf_packet_is_allowed(choice, packet))
        packet++;
    return packet;
}

static void assign(gscl_packet_split *s) {
    uint32_t next = 0;
    for (uint32_t i = 0; i < s->file->header.splat_count; i++) {
        const gsf_packet_choice choice = gsf_packet_choice_of(s->file, i, s->target.count);
        s->packet_of[i] = (uint16_t)(choice.packets == 0 ? next++ % s->target.count : first_for(&choice));
    }
}

gscl_result gscl_packet_split_begin(gscl_packet_split *s) {
    const size_t count = s->file->header.splat_count;
    s->packet_of = malloc((count + 1) * sizeof *s->packet_of);
    s->part.splats = malloc((count + 1) * sizeof *s->part.splats);
    s->scratch = malloc(gsf_scratch_size(&s->file->header) + 8);
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
    s->part.header.packets = (uint16_t)s->target.count;
    s->part.header.packet = (uint8_t)packet;
    s->part.identity = s->target.identity;
    gsf_sort(&s->part, s->scratch);
}

gscl_result gscl_packet_split_measure(gscl_packet_split *s, uint32_t packet) {
    gscl_packet_split_take(s, packet);
    return gscl_result_of_format(gsf_size(&s->part, &s->sizes[packet], s->scratch));
}

gscl_result gscl_packet_split_divide(gscl_packet_split *s) {
    gscl_result result = GSCL_OK;
    assign(s);
    for (uint32_t i = 0; i < s->target.count && result == GSCL_OK; i++)
        result = gscl_packet_split_measure(s, i);
    return result;
}

uint32_t gscl_packet_split_fullest(const gscl_packet_split *s) {
    uint32_t best = 0;
    for (uint32_t i = 1; i < s->target.count; i++)
        best = s->sizes[i] > s->sizes[best] ? i : best;
    return best;
}
