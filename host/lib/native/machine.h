/* What the machine has for this process. */
#ifndef GSCL_LIB_NATIVE_MACHINE_H
#define GSCL_LIB_NATIVE_MACHINE_H

#include <stdint.h>

/* The processors that the calling thread's affinity allows, but no more than the quota of the control groups that the process
 * is in (Linux, cgroup versions 1 and 2), rounded up; at least 1, at most GSCL_MAX_THREADS. */
int gscl_native_thread_count(void);

/* Bytes of memory, used or not. */
uint64_t gscl_native_memory_bytes(void);

#endif
