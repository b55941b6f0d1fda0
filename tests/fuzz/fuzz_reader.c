/* Reads hostile files: input that begins with the magic bytes as a whole file, other input as a bare picture, too, and the
 * first half of each as a prefix.  A file that can be read must also be writable, and writing must be stable: the bytes
 * written from the image must not change when they are read and written again. */
#include <string.h>

#include "coded_memory.h"
#include "mutator.h"
#include "sample.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define USUAL_SPLATS 150u /* images with more take most of the time of fuzzing, and are read by a sample */

static fuzz_memory memory, memory_again;
static uint8_t written[FUZZ_MAX_FILE], written_again[FUZZ_MAX_FILE];

/* Writes an image that was read. */
static size_t write_image(gsf_coded_image *image, uint8_t *bytes) {
    size_t size = 0;
    const size_t bound = gsf_write_bound(image);
    fuzz_require(bound <= FUZZ_MAX_FILE, "a file is larger than was planned");
    fuzz_require(gsf_write(image, bytes, bound, &size, fuzz_scratch(&image->header)) == GSF_OK,
                 "an image that was read cannot be written");
    return size;
}

/* Writes an image that was read, then reads and writes it again. */
static void check_rewriting(gsf_coded_image *image) {
    gsf_coded_image again;
    const size_t size = write_image(image, written);
    fuzz_create(&again, &memory_again, &image->header);
    again.bare = image->bare;
    again.blocks = image->blocks;
    fuzz_require(gsf_read(written, size, &again, fuzz_scratch(&again.header)) == GSF_OK,
                 "a file that was written cannot be read");
    const size_t size_again = write_image(&again, written_again);
    fuzz_require(size == size_again && memcmp(written, written_again, size) == 0, "writing is not stable");
}

/* Touches all that the parts of a file point to. */
static void check_parts(const gsf_container *container) {
    unsigned sum = 0;
    for (int i = 0; i < GSF_BLOCK_COUNT; i++)
        for (size_t k = 0; k < container->blocks[i].size; k++)
            sum += container->blocks[i].data[k];
    for (size_t k = 0; k < container->picture.size; k++)
        sum += container->picture.data[k];
    fuzz_require(sum < UINT32_MAX, "the parts of a file are too large");
}

static void read_prefix(const uint8_t *bytes, size_t size, const gsf_header *header, bool bare) {
    gsf_coded_image image;
    uint32_t total = 0;
    fuzz_create(&image, &memory, header);
    image.bare = bare;
    if (gsf_read_prefix(bytes, size, &image, &total, fuzz_scratch(header)) == GSF_OK)
        fuzz_require(image.header.splat_count <= total && total <= FUZZ_MAX_SPLATS, "a prefix has too many splats");
}

static gsf_result read_and_rewrite(const uint8_t *bytes, size_t size, bool bare) {
    gsf_header header;
    gsf_coded_image image;
    gsf_container container;
    gsf_result result = gsf_read_header(bytes, size, bare, &header);
    if (result != GSF_OK || !fuzz_create(&image, &memory, &header))
        return result;
    if (header.splat_count > USUAL_SPLATS && !fuzz_is_sampled(bytes, size, 16))
        return result;
    image.bare = bare;
    image.stream_bits256 = NULL; /* rewriting counts them */
    result = gsf_read(bytes, size, &image, fuzz_scratch(&header));
    if (result == GSF_OK && fuzz_is_sampled(bytes, size, 4)) {
        if (!bare && gsf_open_container(bytes, size, &container) == GSF_OK) {
            check_parts(&container);
            image.blocks = container.blocks;
        }
        check_rewriting(&image);
    }
    if (fuzz_is_sampled(bytes, size, 8))
        read_prefix(bytes, size / 2, &header, bare);
    return result;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    if (read_and_rewrite(data, size, false) == GSF_NOT_GSCL)
        read_and_rewrite(data, size, true);
    return 0;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed) {
    return fuzz_mutate_file(data, size, max_size, seed);
}
