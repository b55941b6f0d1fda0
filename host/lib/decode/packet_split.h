/* Dividing a coded image among packets (FORMAT.md, "Packets"). */
#ifndef GSCL_LIB_PACKET_SPLIT_H
#define GSCL_LIB_PACKET_SPLIT_H

#include <gscl/gscl.h>

#include "decode/packet_target.h"
#include "format/types.h"

/* The bytes of all packets of a list, without the list's own. */
size_t gscl_packets_bytes(const uint8_t *list, size_t size);

/* Counts the bytes of all packets of a coded image as gscl_packets_write would first divide it, without a limit for each.
 * The splats are in the stored order. */
gscl_result gscl_packets_size(const gsf_coded_image *file, uint32_t packets, size_t *size);

/* Writes a list of packets into a new buffer (gscl_free).  Splats of packets that are too large move to others: those of large
 * cells as they are, others by a few cells.  A splat for which there is no room is dropped, the smallest first, and so is one
 * that equals another.  *file becomes what the list holds.  GSCL_ERROR_BUDGET_TOO_SMALL where not even a packet without splats is within
 * the limit. */
gscl_result gscl_packets_write(gsf_coded_image *file, const gscl_packet_target *target, uint8_t **list, size_t *size);

#endif
