#include "cli/interrupt.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/exit_code.h"
#include "host/system/files.h"
#include "host/system/signals.h"

#define MAX_GUARDED_PATH 4096 /* bytes, the NUL included */

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;        /* guards all variables below */
static char guarded_paths[MAX_GUARDED_FILES][MAX_GUARDED_PATH]; /* empty: none */
static void (*cleanup_program)(void);                           /* NULL: nothing */
static bool is_deferring;
static int pending_signal; /* 0: none */

static void end_program(int number) {
    for (int i = 0; i < MAX_GUARDED_FILES; i++)
        if (guarded_paths[i][0])
            system_remove_file(guarded_paths[i]);
    if (cleanup_program && !system_is_pipe_signal(number)) /* which is handled wherever a thread is */
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

void interrupt_install(void) {
    system_handle_signals(handle_signal, end_program);
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
