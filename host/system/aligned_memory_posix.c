#define _POSIX_C_SOURCE 200809L /* posix_memalign */
#include "host/system/aligned_memory.h"

#include <stdlib.h>

void *gscl_aligned_allocate(size_t alignment, size_t size) {
    void *memory;
    return posix_memalign(&memory, alignment, size) == 0 ? memory : NULL;
}

void gscl_aligned_free(void *memory) {
    free(memory);
}
