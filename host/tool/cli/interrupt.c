#define _DEFAULT_SOURCE /* sigaction, mkstemp, PATH_MAX */
#include "cli/interrupt.h"

#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/exit_code.h"

#define MAX_GUARDED 16

/* Signals are blocked in every thread and fetched by one of our own: compilers inside OpenCL drivers install signal
 * handlers while they work, which would else end the program in their own way. */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER; /* of all below */
static sigset_t waited;
static char guarded_paths[MAX_GUARDED][PATH_MAX]; /* empty: none */
static bool is_patient;
static int pending;

static void end(int number) {
    for (int i = 0; i < MAX_GUARDED; i++)
        if (guarded_paths[i][0])
            unlink(guarded_paths[i]);
    _exit(EXIT_SIGNAL + number);
}

static void handle(int number) {
    pthread_mutex_lock(&lock);
    if (is_patient && pending == 0) {
        pending = number;
        pthread_mutex_unlock(&lock);
        return;
    }
    end(number); /* still locked: nobody opens another file */
}

static void *wait_for_signals(void *unused) {
    int number;
    while (sigwait(&waited, &number) == 0)
        handle(number);
    return unused;
}

void interrupt_install(void) {
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
    pthread_t thread;
    sigemptyset(&waited);
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++) {
        struct sigaction before;
        /* What the parent (nohup, a shell's background job) wants ignored stays ignored. */
        if (sigaction(signals[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN)
            sigaddset(&waited, signals[i]);
    }
    pthread_sigmask(SIG_BLOCK, &waited, NULL);
    if (pthread_create(&thread, NULL, wait_for_signals, NULL) == 0)
        pthread_detach(thread);
    else
        pthread_sigmask(SIG_UNBLOCK, &waited, NULL);
    signal(SIGPIPE, end); /* raised by a write of the thread itself, so never within the lock */
    signal(SIGXFSZ, SIG_IGN);
}

int interrupt_make_guarded(char *pattern) {
    pthread_mutex_lock(&lock);
    int i = 0;
    while (i + 1 < MAX_GUARDED && guarded_paths[i][0])
        i++;
    const int file = mkstemp(pattern);
    if (file >= 0)
        snprintf(guarded_paths[i], sizeof guarded_paths[i], "%s", pattern);
    pthread_mutex_unlock(&lock);
    return file;
}

void interrupt_release_guarded(const char *path) {
    pthread_mutex_lock(&lock);
    for (int i = 0; i < MAX_GUARDED; i++)
        if (strcmp(guarded_paths[i], path) == 0)
            guarded_paths[i][0] = '\0';
    pthread_mutex_unlock(&lock);
}

void interrupt_set_patient(bool patient) {
    pthread_mutex_lock(&lock);
    is_patient = patient;
    pthread_mutex_unlock(&lock);
}

int interrupt_pending(void) {
    pthread_mutex_lock(&lock);
    const int number = pending;
    pthread_mutex_unlock(&lock);
    return number;
}
