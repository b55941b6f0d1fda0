#include "host/system/aligned_memory.h"

#include <malloc.h>

void *gscl_aligned_allocate(size_t alignment, size_t size) {
    return _aligned_malloc(size, alignment);
}

void gscl_aligned_free(void *memory) {
    _aligned_free(memory);
}
