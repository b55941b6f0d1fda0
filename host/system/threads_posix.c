#define _XOPEN_SOURCE 700 /* pthread_sigmask, sigaltstack */
#include "host/system/threads.h"

#include <signal.h>

bool gscl_thread_start(pthread_t *thread, void *(*run)(void *), void *opaque) {
    sigset_t all, before;
    sigfillset(&all);
    if (pthread_sigmask(SIG_SETMASK, &all, &before) != 0)
        return false;
    const bool started = pthread_create(thread, NULL, run, opaque) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return started;
}

void *gscl_with_signal_stack(void *(*run)(void *), void *opaque) {
    stack_t before;
    const bool has_stack = sigaltstack(NULL, &before) == 0;
    void *result = run(opaque);
    if (has_stack)
        sigaltstack(&before, NULL);
    return result;
}
