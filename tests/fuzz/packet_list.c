#include "packet_list.h"

#include <string.h>

#include "format/packet.h"
#include "format/repair.h"

static void check_distinct(const gsf_coded_image *image) {
    for (uint32_t i = 1; i < image->header.splat_count; i++)
        fuzz_require(memcmp(&image->splats[i - 1], &image->splats[i], sizeof *image->splats) != 0,
                     "a splat is there twice");
}

bool packet_list_read(const uint8_t *bytes, size_t size, uint32_t max_splats, fuzz_memory *memory,
                      gsf_coded_image *image) {
    gsf_header header;
    if (!gsf_is_packet_list(bytes, size) || gsf_read_header(bytes, size, false, &header) != GSF_OK ||
        header.splat_count > max_splats || !fuzz_create(image, memory, &header))
        return false;
    const gsf_result result = gsf_read(bytes, size, image, fuzz_scratch(&header));
    fuzz_require(result == GSF_OK || result == GSF_DAMAGED, "a list with a header has another result");
    if (result != GSF_OK)
        return false;
    fuzz_require(image->header.splat_count <= header.splat_count && image->packets_read > 0,
                 "a list has more splats than its packets");
    check_distinct(image);
    return true;
}

size_t packet_list_repair(const uint8_t *bytes, size_t size, uint8_t *list) {
    const size_t room = gsf_repair_size(bytes, size);
    size_t end = 0;
    for (gsf_bytes packet; gsf_next_packet(bytes, size, &end, &packet);)
        continue;
    if (room == 0 || end + room > FUZZ_MAX_FILE)
        return 0;
    memcpy(list, bytes, end);
    const size_t made = gsf_repair_list(bytes, size, list + end);
    fuzz_require(made <= room, "computed packets are larger than their room");
    size_t position = end;
    uint8_t identity;
    gsf_bytes picture;
    for (gsf_bytes packet; gsf_next_packet(list, end + made, &position, &packet);)
        fuzz_require(gsf_open_packet(packet, &identity, &picture) == GSF_OK, "a computed packet is none");
    fuzz_require(made == 0 || position == end + made, "computed packets do not fill their list");
    return end + made;
}
