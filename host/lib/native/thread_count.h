/* The threads that this process may run at the same time. */
#ifndef GSCL_LIB_NATIVE_THREAD_COUNT_H
#define GSCL_LIB_NATIVE_THREAD_COUNT_H

/* The processors that the calling thread's affinity allows, but no more than the quota of the control groups that the process
 * is in (Linux, cgroup versions 1 and 2), rounded up; at least 1, at most GSCL_MAX_THREADS. */
int gscl_native_thread_count(void);

#endif
