#include "coded_memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef __has_feature
#define __has_feature(feature) 0
#endif
#if __has_feature(address_sanitizer) || defined __SANITIZE_ADDRESS__
#include <sanitizer/asan_interface.h>
#else
#define ASAN_POISON_MEMORY_REGION(address, size) ((void)(address), (void)(size))
#define ASAN_UNPOISON_MEMORY_REGION(address, size) ((void)(address), (void)(size))
#endif

/* gsf_scratch_size of FUZZ_MAX_SPLATS splats is below it. */
#define SCRATCH_SIZE 1000000u

#define GUARD 4096u /* bytes behind an array that must not be touched: to guard all of them would take longer */

/* Lets the first `used` of `size` bytes be touched. */
static void limit(void *memory, size_t used, size_t size) {
    const size_t rest = size - used;
    ASAN_UNPOISON_MEMORY_REGION(memory, used);
    ASAN_POISON_MEMORY_REGION((uint8_t *)memory + used, rest < GUARD ? rest : GUARD);
}

bool fuzz_create(gsf_coded_image *image, fuzz_memory *memory, const gsf_header *header) {
    const uint32_t count = header->splat_count;
    if (count > FUZZ_MAX_SPLATS)
        return false;
    limit(memory->splats, count * sizeof *memory->splats, sizeof memory->splats);
    limit(memory->indexed, count * sizeof *memory->indexed, sizeof memory->indexed);
    *image = (gsf_coded_image){.header = *header,
                               .splats = memory->splats,
                               .indexed = memory->indexed,
                               .stream_bits256 = memory->stream_bits256,
                               .codebooks = {.shape_words = memory->shape_words, .colour_words = memory->colour_words}};
    return true;
}

void *fuzz_scratch(const gsf_header *header) {
    static uint64_t scratch[SCRATCH_SIZE / sizeof(uint64_t)];
    const size_t size = gsf_scratch_size(header);
    fuzz_require(size <= sizeof scratch, "the working memory is larger than was planned");
    limit(scratch, size, sizeof scratch);
    return scratch;
}

void fuzz_require(bool condition, const char *message) {
    if (!condition) {
        fprintf(stderr, "fuzz: %s\n", message);
        abort();
    }
}
