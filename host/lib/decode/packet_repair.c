/* Packets of a list that are computed from its repair packets, in memory of the caller. */
#include <gscl/gscl.h>
#include <string.h>

#include "format/packet.h"
#include "format/repair.h"

/* The bytes of a list up to the end of its last packet that is complete. */
static size_t complete_size(const uint8_t *list, size_t size) {
    size_t end = 0;
    for (gsf_bytes packet; gsf_next_packet(list, size, &end, &packet);)
        continue;
    return end;
}

size_t gscl_repair_memory(const uint8_t *list, size_t size) {
    const size_t needed = list && gsf_is_packet_list(list, size) ? gsf_repair_size(list, size) : 0;
    return needed > 0 ? complete_size(list, size) + needed : 0;
}

gscl_result gscl_repair_packets(const uint8_t *list, size_t size, void *memory, size_t memory_size,
                                size_t *repaired_size) {
    const size_t needed = gscl_repair_memory(list, size), end = needed > 0 ? complete_size(list, size) : 0;
    if (!memory || !repaired_size || needed == 0)
        return GSCL_ERROR_INVALID_ARGUMENT;
    if (memory_size < needed)
        return GSCL_ERROR_OUT_OF_MEMORY;
    memcpy(memory, list, end);
    *repaired_size = end + gsf_repair_list(list, size, (uint8_t *)memory + end);
    return GSCL_OK;
}
