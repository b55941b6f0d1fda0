#include "host/system/threads.h"

bool gscl_thread_start(pthread_t *thread, void *(*run)(void *), void *opaque) {
    return pthread_create(thread, NULL, run, opaque) == 0;
}

void *gscl_with_signal_stack(void *(*run)(void *), void *opaque) {
    return run(opaque);
}
