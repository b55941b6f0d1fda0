/* Reads hostile files.  The checksum is put right first, so that the content behind it is reached; what reads well must write
 * to the same bytes or, when the order within a cell was not the writer's, to bytes that read the same.
 *
 * With libFuzzer:  clang -fsanitize=fuzzer,address,undefined -I. tests/fuzz/fuzz_format.c format/[a-z]*.c
 * As a replay of saved inputs: add -DREPLAY, leave out "fuzzer", and give the files as arguments. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "format/format.h"
#include "format/header.h"

#define MOST_SPLATS 20000u /* more would only be slower */

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void *allocate(size_t size) {
    void *memory = malloc(size > 0 ? size : 1);
    if (memory == NULL)
        abort();
    return memory;
}

static uint64_t stream_bits256[GSF_STREAM_COUNT];

static void create(gsf_coded_image *picture, const gsf_header *header) {
    memset(picture, 0, sizeof *picture);
    picture->stream_bits256 = stream_bits256;
    picture->header = *header;
    picture->splats = allocate(header->splat_count * sizeof *picture->splats);
    picture->indexed = allocate(header->splat_count * sizeof *picture->indexed);
    picture->codebooks.shape_words = allocate(GSF_MAX_CODEBOOK * sizeof *picture->codebooks.shape_words);
    picture->codebooks.colour_words = allocate(GSF_MAX_CODEBOOK * sizeof *picture->codebooks.colour_words);
}

static void destroy(gsf_coded_image *picture) {
    free(picture->splats);
    free(picture->indexed);
    free(picture->codebooks.shape_words);
    free(picture->codebooks.colour_words);
}

static void check(bool truth, const char *what) {
    if (!truth) {
        fprintf(stderr, "fuzz_format: %s\n", what);
        abort();
    }
}

/* Writes a picture; the caller frees the bytes. */
static uint8_t *write_picture(gsf_coded_image *picture, size_t *size, void *scratch) {
    const size_t bound = gsf_write_bound(picture);
    uint8_t *bytes = allocate(bound);
    check(gsf_write(picture, bytes, bound, size, scratch) == GSF_OK, "what was read cannot be written");
    return bytes;
}

/* The picture that was read, written, read and written again. */
static void check_rewriting(gsf_coded_image *picture, void *scratch) {
    size_t size, size_again;
    gsf_coded_image again;
    uint8_t *bytes = write_picture(picture, &size, scratch);
    create(&again, &picture->header);
    check(gsf_read(bytes, size, &again, scratch) == GSF_OK, "what was written cannot be read");
    uint8_t *bytes_again = write_picture(&again, &size_again, scratch);
    check(size == size_again && memcmp(bytes, bytes_again, size) == 0, "writing is not stable");
    destroy(&again);
    free(bytes_again);
    free(bytes);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    gsf_header header;
    size_t start;
    uint8_t *bytes = allocate(size);
    memcpy(bytes, data, size);
    if (gsf_parse_header(bytes, size, &header, &start) == GSF_OK && header.splat_count <= MOST_SPLATS) {
        gsf_coded_image picture;
        void *scratch = allocate(gsf_scratch_size(&header));
        create(&picture, &header);
        gsf_read(bytes, size, &picture, scratch);
        gsf_store_checksum(bytes, size, start);
        if (gsf_read(bytes, size, &picture, scratch) == GSF_OK)
            check_rewriting(&picture, scratch);
        destroy(&picture);
        free(scratch);
    }
    free(bytes);
    return 0;
}

#ifdef REPLAY
static void replay(const char *path) {
    enum { LARGEST = 1 << 24 };
    FILE *file = fopen(path, "rb");
    uint8_t *bytes = allocate(LARGEST);
    if (file != NULL) {
        const size_t size = fread(bytes, 1, LARGEST, file);
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
