/* What the machine has for this process. */
#ifndef GSCL_SYSTEM_MACHINE_H
#define GSCL_SYSTEM_MACHINE_H

#include <stdint.h>

/* The processors that the calling thread's affinity allows (Linux, Windows), but no more than the quota of the control groups
 * that the process is in (Linux, cgroup versions 1 and 2), rounded up; below 1 where the system does not say. */
double gscl_processor_count(void);

/* Bytes of memory, used or not; 0 where the system does not say. */
uint64_t gscl_memory_bytes(void);

#endif
