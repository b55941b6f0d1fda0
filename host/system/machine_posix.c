#define _DEFAULT_SOURCE /* _SC_NPROCESSORS_ONLN, _SC_PHYS_PAGES */
#include "host/system/machine.h"

#include <unistd.h>

double gscl_processor_count(void) {
    return (double)sysconf(_SC_NPROCESSORS_ONLN);
}

uint64_t gscl_memory_bytes(void) {
    const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    return pages > 0 && page > 0 ? (uint64_t)pages * (uint64_t)page : 0;
}
