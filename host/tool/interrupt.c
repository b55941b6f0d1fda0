#define _DEFAULT_SOURCE /* sigaction, PATH_MAX */
#include "interrupt.h"

#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Signal handlers see nothing but global state. */
static char guarded_path[PATH_MAX];
static volatile sig_atomic_t has_guarded;
static volatile sig_atomic_t is_patient;
static volatile sig_atomic_t pending;

static void handle_signal(int number) {
    if (is_patient && pending == 0 && number != SIGPIPE) {
        pending = number;
        return;
    }
    if (has_guarded)
        unlink(guarded_path);
    _exit(128 + number);
}

void interrupt_install(void) {
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE};
    struct sigaction action = {.sa_handler = handle_signal, .sa_flags = SA_RESTART};
    sigemptyset(&action.sa_mask);
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++) {
        struct sigaction before;
        /* What the parent (nohup, a shell's background job) wants ignored stays ignored. */
        if (sigaction(signals[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN)
            sigaction(signals[i], &action, NULL);
    }
    signal(SIGXFSZ, SIG_IGN);
}

void interrupt_guard(const char *path) {
    has_guarded = 0;
    if (path) {
        snprintf(guarded_path, sizeof guarded_path, "%s", path);
        has_guarded = 1;
    }
}

void interrupt_set_patient(bool patient) {
    is_patient = patient;
}

int interrupt_pending(void) {
    return pending;
}
