/* Numbers from the bytes of a fuzzed input.  After its end all bytes are 0, so that each input means something. */
#ifndef GSCL_FUZZ_BYTE_SOURCE_H
#define GSCL_FUZZ_BYTE_SOURCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct byte_source {
    const uint8_t *at;
    size_t left;
} byte_source;

static inline uint8_t source_byte(byte_source *source) {
    if (source->left == 0)
        return 0;
    source->left--;
    return *source->at++;
}

/* The next bit of a byte would save space, but a mutation would then shift all that follows. */
static inline bool source_flag(byte_source *source) {
    return source_byte(source) % 2 != 0;
}

/* A number from `min` to `max`, of two bytes where one does not suffice. */
static inline int source_within(byte_source *source, int min, int max) {
    const unsigned count = (unsigned)(max - min) + 1u;
    unsigned value = source_byte(source);
    if (count > 256)
        value = value << 8 | source_byte(source);
    return min + (int)(value % count);
}

#endif
