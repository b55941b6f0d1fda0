/* A coded image that is being divided among packets: which splat is in which packet, and the size of each. */
#ifndef GSCL_LIB_PACKET_PARTS_H
#define GSCL_LIB_PACKET_PARTS_H

#include <gscl/gscl.h>

#include "decode/packet_target.h"
#include "format/types.h"

/* A coded image that is being divided. */
typedef struct gscl_packet_split {
    gsf_coded_image *file;
    uint32_t packets;
    gscl_packet_target target;     /* where it is written, not only measured */
    uint16_t *packet_of;           /* the packet of each splat */
    size_t sizes[GSF_MAX_PACKETS]; /* bytes */
    gsf_coded_image part;          /* one packet, whose splats are a copy */
    void *scratch;
} gscl_packet_split;

/* Sets up the lists; the caller frees in any case.  The splats of `file` are in the stored order. */
gscl_result gscl_packet_split_begin(gscl_packet_split *s, const gsf_coded_image *file);
void gscl_packet_split_free(gscl_packet_split *s);

/* Divides the splats: those that all packets may hold go round, the others belong to the packet of their cell. */
void gscl_packet_split_assign(gscl_packet_split *s);

/* s->part becomes a packet, in its own stored order. */
void gscl_packet_split_take(gscl_packet_split *s, uint32_t packet);

/* Measures one packet, and all. */
gscl_result gscl_packet_split_measure(gscl_packet_split *s, uint32_t packet);
gscl_result gscl_packet_split_measure_all(gscl_packet_split *s);

/* The largest packet. */
uint32_t gscl_packet_split_fullest(const gscl_packet_split *s);

#endif
