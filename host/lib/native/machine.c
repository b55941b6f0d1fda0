#include "native/machine.h"

#include <gscl/gscl.h>

#include "host/system/machine.h"

int gscl_native_thread_count(void) {
    const double count = gscl_processor_count();
    return count < 1 ? 1 : count > GSCL_MAX_THREADS ? GSCL_MAX_THREADS : (int)count;
}

uint64_t gscl_native_memory_bytes(void) {
    const uint64_t bytes = gscl_memory_bytes();
    return bytes > 0 ? bytes : SIZE_MAX / 2;
}
