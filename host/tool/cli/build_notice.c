#define _POSIX_C_SOURCE 200809L
#include "cli/build_notice.h"

#include <pthread.h>
#include <time.h>

#include "cli/message.h"

/* A thread waits for the moment of the note, because a build is one call of OpenCL. */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER; /* guards all variables below */
static pthread_cond_t changed = PTHREAD_COND_INITIALIZER;
static int building;    /* contexts that build kernels now */
static double ended_s;  /* seconds that kernels were built before */
static double begun_s;  /* when the first of these contexts began, on the clock of seconds_now */
static bool has_thread; /* the thread was started; it ends after the note */

static double seconds_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Waits, at most until a moment, for a build to begin or end. */
static void wait_until(double moment) {
    const struct timespec end = {.tv_sec = (time_t)moment, .tv_nsec = (long)(1e9 * (moment - (double)(time_t)moment))};
    pthread_cond_timedwait(&changed, &lock, &end);
}

static void *wait_for_note(void *unused) {
    pthread_mutex_lock(&lock);
    for (;;) {
        const double due = begun_s + BUILD_NOTICE_SECONDS - ended_s;
        if (building == 0)
            pthread_cond_wait(&changed, &lock);
        else if (seconds_now() < due)
            wait_until(due);
        else
            break;
    }
    pthread_mutex_unlock(&lock);
    report_note(BUILD_NOTICE);
    return unused;
}

static void start_thread(void) {
    pthread_t thread;
    has_thread = pthread_create(&thread, NULL, wait_for_note, NULL) == 0;
    if (has_thread)
        pthread_detach(thread);
}

void build_notice(void *unused, bool begins) {
    (void)unused;
    pthread_mutex_lock(&lock);
    if (begins && building++ == 0)
        begun_s = seconds_now();
    if (!begins && --building == 0)
        ended_s += seconds_now() - begun_s;
    if (!has_thread)
        start_thread();
    pthread_cond_signal(&changed);
    pthread_mutex_unlock(&lock);
}
