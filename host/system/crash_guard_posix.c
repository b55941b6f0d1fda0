#define _XOPEN_SOURCE 700 /* sigaltstack */
#include "host/system/crash_guard.h"

#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define STACK_SIZE 65536 /* bytes: the crash may be that no stack is left */
#define NOTICE_SIZE 4096

static const int crashes[] = {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT};
#define CRASH_COUNT (sizeof crashes / sizeof *crashes)

/* All that the handler needs, since it may call functions of the system only. */
static struct {
    pthread_t thread;
    const crash_line *line;
    char notice[NOTICE_SIZE];
    size_t notice_size;
    struct sigaction before[CRASH_COUNT];
    uint8_t stack[STACK_SIZE];
    char *words; /* the command line, each word with its NUL */
    char **arguments;
} guard;

/* Reads the command line as the system keeps it, because getopt sorts that of the program.  Without memory it stays NULL. */
static void read_arguments(void) {
    size_t size = 0, capacity = 0, count = 0;
    FILE *stream = fopen("/proc/self/cmdline", "rb"), *words = open_memstream(&guard.words, &size);
    char *word = NULL;
    while (stream && words && getdelim(&word, &capacity, '\0', stream) > 0)
        count += fwrite(word, 1, strlen(word) + 1, words) > 0;
    free(word);
    if (stream)
        fclose(stream);
    if (words && fclose(words) == 0)
        guard.arguments = calloc(count + 1, sizeof *guard.arguments);
    char *next = guard.words;
    for (size_t i = 0; guard.arguments && i < count; i++, next += strlen(next) + 1)
        guard.arguments[i] = next;
}

/* Ends the program as if nothing had handled the signal. */
static void end_by_signal(int number) {
    sigset_t set;
    signal(number, SIG_DFL);
    sigemptyset(&set);
    sigaddset(&set, number);
    pthread_sigmask(SIG_UNBLOCK, &set, NULL);
    raise(number);
}

static bool put(int file, const char *bytes, size_t size) {
    return write(file, bytes, size) == (ssize_t)size;
}

static void on_crash(int number) {
    sigset_t none;
    if (!pthread_equal(pthread_self(), guard.thread)) { /* not of the image */
        end_by_signal(number);
        return;
    }
    const crash_line *line = guard.line;
    put(STDERR_FILENO, guard.notice, guard.notice_size);
    const bool is_recorded = line->file >= 0 && put(line->file, line->text, line->size);
    if (is_recorded && line->starts_again && guard.arguments) {
        sigemptyset(&none);
        pthread_sigmask(SIG_SETMASK, &none, NULL);
        execv("/proc/self/exe", guard.arguments);
    }
    end_by_signal(number);
}

void crash_guard_begin(const char *label, const crash_line *line) {
    const stack_t stack = {.ss_sp = guard.stack, .ss_size = sizeof guard.stack};
    struct sigaction action = {.sa_handler = on_crash, .sa_flags = SA_ONSTACK};
    if (!guard.arguments)
        read_arguments();
    guard.thread = pthread_self();
    guard.line = line;
    const int size =
        snprintf(guard.notice, sizeof guard.notice, "gscl: %.3000s: the library that reads it has crashed%s\n", label,
                 line->starts_again ? "; the run goes on without it" : "");
    guard.notice_size = size > 0 ? (size_t)size : 0;
    sigaltstack(&stack, NULL);
    sigemptyset(&action.sa_mask);
    for (size_t i = 0; i < CRASH_COUNT; i++)
        sigaction(crashes[i], &action, &guard.before[i]);
}

void crash_guard_end(void) {
    for (size_t i = 0; i < CRASH_COUNT; i++)
        sigaction(crashes[i], &guard.before[i], NULL);
}
