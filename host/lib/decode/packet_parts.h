/* A coded image that is being divided among packets: which splat is in which packet, and the size of each. */
#ifndef GSCL_LIB_PACKET_PARTS_H
#define GSCL_LIB_PACKET_PARTS_H

#include <gscl/gscl.h>

#include "decode/packet_target.h"
#include "format/types.h"

/* A coded image that is being divided. */
typedef struct gscl_packet_split {
    gsf_coded_image *file;
    gscl_packet_target target;     /* of what is only measured, the number of packets alone counts */
    uint16_t *packet_of;           /* the packet of each splat */
    size_t sizes[GSF_MAX_PACKETS]; /* bytes */
    gsf_coded_image part;          /* one packet, whose splats are a copy */
    void *scratch;
} gscl_packet_split;

/* Sets up the lists for s->file, whose splats are in the stored order; the caller frees in any case. */
gscl_result gscl_packet_split_begin(gscl_packet_split *s);
void gscl_packet_split_free(gscl_packet_split *s);

/* Divides the splats, and measures all packets: splats that all packets may hold go round, the others belong to the packet of
 * their cell. */
gscl_result gscl_packet_split_divide(gscl_packet_split *s);

/* s->part becomes a packet, in its own stored order. */
void gscl_packet_split_take(gscl_packet_split *s, uint32_t packet);

/* Measures a packet. */
gscl_result gscl_packet_split_measure(gscl_packet_split *s, uint32_t packet);

/* The largest packet. */
uint32_t gscl_packet_split_fullest(const gscl_packet_split *s);

#endif
