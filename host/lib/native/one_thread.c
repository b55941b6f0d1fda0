/* In place of pool.c and machine.c where there are no threads: WebAssembly. */
#include "native/machine.h"
#include "native/pool.h"

int gscl_native_thread_count(void) {
    return 1;
}

uint64_t gscl_native_memory_bytes(void) {
    return (uint64_t)1 << 32; /* addresses have 32 bits */
}

gscl_result gscl_pool_create(gscl_context *context, int threads, gscl_pool **pool) {
    (void)context, (void)threads;
    *pool = NULL;
    return GSCL_OK;
}

void gscl_pool_free(gscl_pool *pool) {
    (void)pool;
}

int gscl_pool_run(gscl_pool *pool, int threads, size_t count, size_t part, gscl_pool_work *work, const void *opaque) {
    (void)pool, (void)threads, (void)part;
    work(opaque, 0, count);
    return 1;
}
