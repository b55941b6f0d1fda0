/* Threads, whose locks are those of POSIX everywhere. */
#ifndef GSCL_SYSTEM_THREADS_H
#define GSCL_SYSTEM_THREADS_H

#include <pthread.h>
#include <stdbool.h>

/* Starts a thread that handles no signals: those are for the threads of the program.  Returns false when there is none. */
bool gscl_thread_start(pthread_t *thread, void *(*run)(void *), void *opaque);

/* Runs a function, and gives the thread its own stack for signals back afterwards: AddressSanitizer releases a thread's stack, and
 * ends the program where it is not the one that it made. */
void *gscl_with_signal_stack(void *(*run)(void *), void *opaque);

#endif
