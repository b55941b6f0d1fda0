#define _DEFAULT_SOURCE /* sigaction, PATH_MAX */
#include "cli/interrupt.h"

#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/exit_code.h"

/* Signals are blocked in every thread and received by a thread for signals.  Compilers inside OpenCL drivers install
 * signal handlers while they work, which would otherwise end the program without removing its files. */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER; /* guards all variables below */
static sigset_t handled_signals;
static char guarded_paths[MAX_GUARDED_FILES][PATH_MAX]; /* empty: none */
static void (*cleanup_program)(void);                   /* NULL: nothing */
static bool is_deferring;
static int pending_signal; /* 0: none */

static void end_program(int number) {
    for (int i = 0; i < MAX_GUARDED_FILES; i++)
        if (guarded_paths[i][0])
            unlink(guarded_paths[i]);
    if (cleanup_program &&
        number != SIGPIPE) /* which is handled wherever a thread is, and not in the thread for signals */
        cleanup_program();
    _exit(EXIT_SIGNAL + number);
}

static void handle_signal(int number) {
    pthread_mutex_lock(&lock);
    if (is_deferring && pending_signal == 0) {
        pending_signal = number;
        pthread_mutex_unlock(&lock);
        return;
    }
    end_program(number); /* the lock stays held, so that no other file is opened */
}

static void *wait_for_signals(void *unused) {
    int number;
    while (sigwait(&handled_signals, &number) == 0)
        handle_signal(number);
    return unused;
}

void interrupt_install(void) {
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGALRM, SIGXCPU, SIGUSR1, SIGUSR2};
    pthread_t thread;
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
    signal(SIGPIPE, end_program); /* raised by a write of the thread itself, so never while the lock is held */
    signal(SIGXFSZ, SIG_IGN);
}

void interrupt_set_cleanup(void (*cleanup)(void)) {
    pthread_mutex_lock(&lock);
    cleanup_program = cleanup;
    pthread_mutex_unlock(&lock);
}

int interrupt_make_guarded(char *pattern, int (*make)(char *pattern)) {
    pthread_mutex_lock(&lock);
    int i = 0;
    while (i + 1 < MAX_GUARDED_FILES && guarded_paths[i][0])
        i++;
    const int file = make(pattern);
    if (file >= 0)
        snprintf(guarded_paths[i], sizeof guarded_paths[i], "%s", pattern);
    pthread_mutex_unlock(&lock);
    return file;
}

void interrupt_release_guarded(const char *path) {
    pthread_mutex_lock(&lock);
    for (int i = 0; i < MAX_GUARDED_FILES; i++)
        if (strcmp(guarded_paths[i], path) == 0)
            guarded_paths[i][0] = '\0';
    pthread_mutex_unlock(&lock);
}

void interrupt_set_deferring(bool deferring) {
    pthread_mutex_lock(&lock);
    is_deferring = deferring;
    pthread_mutex_unlock(&lock);
}

int interrupt_pending(void) {
    pthread_mutex_lock(&lock);
    const int number = pending_signal;
    pthread_mutex_unlock(&lock);
    return number;
}
