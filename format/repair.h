/* Repair packets: an erasure code over the packets of a picture, from which packets that were lost are computed again
 * (FORMAT.md, "Repair packets"). */
#ifndef GSCL_FORMAT_REPAIR_H
#define GSCL_FORMAT_REPAIR_H

#include "format/types.h"

#define GSF_REPAIR_FRAME \
    4u /* bytes of a repair packet besides its content, which is as long as the longest packet less 1 */

/* Writes repair packet `number`, count..255, of a picture's packets [0..count), of which the longest has `longest` bytes.
 * `repair` has room for longest - 1 + GSF_REPAIR_FRAME bytes, which is its size. */
void gsf_write_repair(const gsf_bytes *packets, uint32_t count, size_t longest, uint32_t number, uint8_t *repair);

/* Whether this is a repair packet; sets what it says of itself. */
bool gsf_open_repair(gsf_bytes packet, uint8_t *identity, uint32_t *number);

/* Bytes of memory that gsf_repair_list needs for a list; 0 where it can compute nothing. */
size_t gsf_repair_size(const uint8_t *list, size_t size);
/* Computes the packets that a list lacks, where it has as many repair packets.  Writes them to the start of `memory` as they
 * stand in a list; returns the bytes of that. */
size_t gsf_repair_list(const uint8_t *list, size_t size, uint8_t *memory);

#endif
