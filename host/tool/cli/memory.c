#include "cli/memory.h"

#include <stdlib.h>

#ifdef __GLIBC__
#include <malloc.h>

#define LEAST_BLOCK (1 << 20) /* bytes that go back */

/* By default glibc keeps more and more of what is freed, up to 32 MiB a block: 60 MiB of an encode of 6 megapixels. */
void memory_return_freed(void) {
    mallopt(M_MMAP_THRESHOLD, LEAST_BLOCK);
}
#else
void memory_return_freed(void) {
}
#endif
