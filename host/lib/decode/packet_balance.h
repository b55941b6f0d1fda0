/* Bringing all packets of a coded image within their limit. */
#ifndef GSCL_LIB_PACKET_BALANCE_H
#define GSCL_LIB_PACKET_BALANCE_H

#include "decode/packet_parts.h"

/* Moves splats from packets that are too large to others, and drops those for which there is no room, until all packets,
 * which are measured, are within the limit. */
gscl_result gscl_packet_balance(gscl_packet_split *s);

#endif
