#include "sample.h"

bool fuzz_is_sampled(const uint8_t *bytes, size_t size, unsigned interval) {
#ifdef FUZZ_SAMPLE
    uint32_t hash = 2166136261u; /* FNV-1a */
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ bytes[i]) * 16777619u;
    return (hash >> 16) % interval == 0;
#else
    return interval > 0 && size > 0 && bytes != NULL;
#endif
}
