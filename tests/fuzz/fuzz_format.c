/* Reads hostile files.  Each input is read as it is, again with its check made to match, so that its errors are others,
 * and again as a bare picture.  A file that can be read must also be writable, and writing must be stable: the bytes written from the image
 * must not change when they are read and written again.
 *
 * With libFuzzer:  clang -fsanitize=fuzzer,address,undefined -I. tests/fuzz/fuzz_format.c format/[a-z]*.c
 * As a replay of saved inputs: add -DREPLAY, leave out "fuzzer", and give the files as arguments. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "format/format.h"

#define MAX_SPLATS 20000u /* keeps the time of an input short */

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void *allocate(size_t size) {
    void *memory = malloc(size > 0 ? size : 1);
    if (memory == NULL)
        abort();
    return memory;
}

static uint64_t stream_bits256[GSF_STREAM_COUNT];

static void create(gsf_coded_image *image, const gsf_header *header) {
    memset(image, 0, sizeof *image);
    image->stream_bits256 = stream_bits256;
    image->header = *header;
    image->splats = allocate(header->splat_count * sizeof *image->splats);
    image->indexed = allocate(header->splat_count * sizeof *image->indexed);
    image->codebooks.shape_words = allocate(GSF_MAX_CODEBOOK * sizeof *image->codebooks.shape_words);
    image->codebooks.colour_words = allocate(GSF_MAX_CODEBOOK * sizeof *image->codebooks.colour_words);
}

static void destroy(gsf_coded_image *image) {
    free(image->splats);
    free(image->indexed);
    free(image->codebooks.shape_words);
    free(image->codebooks.colour_words);
}

static void require(bool condition, const char *message) {
    if (!condition) {
        fprintf(stderr, "fuzz_format: %s\n", message);
        abort();
    }
}

/* Writes a image; the caller frees the bytes. */
static uint8_t *write_image(gsf_coded_image *image, size_t *size, void *scratch) {
    const size_t bound = gsf_write_bound(image);
    uint8_t *bytes = allocate(bound);
    require(gsf_write(image, bytes, bound, size, scratch) == GSF_OK, "an image that was read cannot be written");
    return bytes;
}

/* Writes an image that was read, then reads and writes it again. */
static void check_rewriting(gsf_coded_image *image, void *scratch) {
    size_t size, size_again;
    gsf_coded_image again;
    uint8_t *bytes = write_image(image, &size, scratch);
    create(&again, &image->header);
    again.bare = image->bare;
    again.blocks = image->blocks;
    require(gsf_read(bytes, size, &again, scratch) == GSF_OK, "a file that was written cannot be read");
    uint8_t *bytes_again = write_image(&again, &size_again, scratch);
    require(size == size_again && memcmp(bytes, bytes_again, size) == 0, "writing is not stable");
    destroy(&again);
    free(bytes_again);
    free(bytes);
}

static void read_and_rewrite(const uint8_t *bytes, size_t size, bool bare) {
    gsf_header header;
    gsf_coded_image image;
    gsf_container container;
    if (gsf_read_header(bytes, size, bare, &header) != GSF_OK || header.splat_count > MAX_SPLATS)
        return;
    void *scratch = allocate(gsf_scratch_size(&header));
    create(&image, &header);
    image.bare = bare;
    if (gsf_read(bytes, size, &image, scratch) == GSF_OK) {
        if (!bare && gsf_open_container(bytes, size, &container) == GSF_OK)
            image.blocks = container.blocks;
        check_rewriting(&image, scratch);
    }
    destroy(&image);
    free(scratch);
}

/* Opens the container and touches all that it points to. */
static unsigned sum_of_parts(const uint8_t *bytes, size_t size) {
    gsf_container container;
    unsigned sum = 0;
    if (gsf_open_container(bytes, size, &container) != GSF_OK)
        return 0;
    for (int i = 0; i < GSF_BLOCK_COUNT; i++)
        for (size_t k = 0; k < container.blocks[i].size; k++)
            sum += container.blocks[i].data[k];
    for (size_t k = 0; k < container.picture.size; k++)
        sum += container.picture.data[k];
    return sum;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    uint8_t *bytes = allocate(size);
    memcpy(bytes, data, size);
    read_and_rewrite(bytes, size, false);
    read_and_rewrite(bytes, size, true);
    if (size >= 2) {
        const uint16_t crc = gsf_crc16(bytes, size - 2);
        bytes[size - 2] = (uint8_t)(crc >> 8);
        bytes[size - 1] = (uint8_t)crc;
        read_and_rewrite(bytes, size, false);
        require(sum_of_parts(bytes, size) < UINT32_MAX, "the parts of a file add up to nothing sensible");
    }
    free(bytes);
    return 0;
}

#ifdef REPLAY
static void replay(const char *path) {
    enum { MAX_SIZE = 1 << 24 };
    FILE *file = fopen(path, "rb");
    uint8_t *bytes = allocate(MAX_SIZE);
    if (file != NULL) {
        const size_t size = fread(bytes, 1, MAX_SIZE, file);
        fclose(file);
        LLVMFuzzerTestOneInput(bytes, size);
    } else {
        perror(path);
        exit(EXIT_FAILURE);
    }
    free(bytes);
}

int main(int argc, char **argv) {
    for (int i = 1; i < argc; i++)
        replay(argv[i]);
    return EXIT_SUCCESS;
}
#endif
