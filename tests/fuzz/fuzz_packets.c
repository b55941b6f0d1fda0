/* Reads hostile lists of packets: what is read can be written as a file, which reads back equal, and what repair packets give are
 * packets. */
#include <string.h>

#include "mutator.h"
#include "packet_list.h"
#include "sample.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define USUAL_SPLATS 40u /* lists with more in all packets take most of the time of fuzzing: a sample of them is read */

static fuzz_memory memory, memory_again;
static uint8_t file[FUZZ_MAX_FILE], list[FUZZ_MAX_FILE];

/* Writes what was read from a list as a file, and reads it back. */
static void check_rewriting(gsf_coded_image *image) {
    gsf_coded_image again;
    gsf_header header;
    size_t size = 0;
    image->stream_bits256 = NULL;
    fuzz_require(gsf_write_bound(image) <= FUZZ_MAX_FILE, "a file is larger than was planned");
    fuzz_require(gsf_write(image, file, sizeof file, &size, fuzz_scratch(&image->header)) == GSF_OK,
                 "what was read from packets cannot be written");
    fuzz_require(gsf_read_header(file, size, false, &header) == GSF_OK, "the header of a written file cannot be read");
    fuzz_require(fuzz_create(&again, &memory_again, &header), "a file has more splats than its packets");
    fuzz_require(gsf_read(file, size, &again, fuzz_scratch(&header)) == GSF_OK, "a written file cannot be read");
    fuzz_require(again.header.splat_count == image->header.splat_count &&
                     memcmp(again.splats, image->splats, again.header.splat_count * sizeof *again.splats) == 0,
                 "the splats of packets are not in the stored order");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    gsf_coded_image image;
    const uint32_t most = fuzz_is_sampled(data, size, 16) ? FUZZ_MAX_SPLATS : USUAL_SPLATS;
    if (packet_list_read(data, size, most, &memory, &image) && fuzz_is_sampled(data, size, 4))
        check_rewriting(&image);
    const size_t repaired = packet_list_repair(data, size, list);
    if (repaired > 0)
        (void)packet_list_read(list, repaired, most, &memory, &image);
    return 0;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed) {
    return fuzz_mutate_packets(data, size, max_size, seed);
}
