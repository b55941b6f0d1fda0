#define _DEFAULT_SOURCE /* sigaction, strsignal */
#include "host/system/signals.h"

#include <pthread.h>
#include <signal.h>
#include <stddef.h>
#include <string.h>

/* Signals are blocked in every thread and received by a thread for signals.  Compilers inside OpenCL drivers install
 * signal handlers while they work, which would otherwise end the program without removing its files. */
static sigset_t handled_signals;
static void (*handle_signal)(int number);

static void *wait_for_signals(void *unused) {
    int number;
    while (sigwait(&handled_signals, &number) == 0)
        handle_signal(number);
    return unused;
}

void system_handle_signals(void (*handle)(int number), void (*end)(int number)) {
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGALRM, SIGXCPU, SIGUSR1, SIGUSR2};
    pthread_t thread;
    handle_signal = handle;
    sigemptyset(&handled_signals);
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++) {
        struct sigaction before;
        /* A signal that the parent ignores (nohup, a background job of a shell) stays ignored. */
        if (sigaction(signals[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN)
            sigaddset(&handled_signals, signals[i]);
    }
    pthread_sigmask(SIG_BLOCK, &handled_signals, NULL);
    if (pthread_create(&thread, NULL, wait_for_signals, NULL) == 0)
        pthread_detach(thread);
    else
        pthread_sigmask(SIG_UNBLOCK, &handled_signals, NULL);
    signal(SIGPIPE, end); /* raised by a write of the thread itself */
    signal(SIGXFSZ, SIG_IGN);
}

int system_is_pipe_signal(int number) {
    return number == SIGPIPE;
}

const char *system_signal_text(int number) {
    return strsignal(number);
}
