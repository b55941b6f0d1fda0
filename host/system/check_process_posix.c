#define _DEFAULT_SOURCE
#include "host/system/check_process.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include "host/system/clock.h"

/* In the child: signals end it as usual, and so does the end of its parent. */
static void prepare_child(void) {
    sigset_t all;
    sigfillset(&all);
    signal(SIGPIPE, SIG_DFL);
    sigprocmask(SIG_UNBLOCK, &all, NULL);
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
}

/* Whether there is something to read before a moment. */
static bool wait_for_input(int pipe, double end_s) {
    for (;;) {
        struct pollfd input = {.fd = pipe, .events = POLLIN};
        const double left_ms = ceil(1e3 * (end_s - gscl_now()));
        if (left_ms <= 0)
            return false;
        const int count = poll(&input, 1, left_ms < 1e6 ? (int)left_ms : 1000000);
        if (count > 0)
            return true;
        if (count < 0 && errno != EINTR)
            return false;
    }
}

/* Receives records until the child ends.  Returns false after the time limit. */
static bool receive_records(const check_process *process, int pipe, double end_s) {
    char record[CHECK_MAX_RECORD];
    size_t filled = 0;
    while (wait_for_input(pipe, end_s)) {
        const ssize_t count = read(pipe, record + filled, process->record_size - filled);
        if (count == 0 || (count < 0 && errno != EINTR))
            return true;
        filled += count > 0 ? (size_t)count : 0;
        if (filled == process->record_size) {
            process->receive(process->opaque, record);
            filled = 0;
        }
    }
    return false;
}

/* A process that closed its pipe may still hang in the end of an OpenCL implementation. */
static bool wait_for_end(pid_t child, double end_s, int *status) {
    while (waitpid(child, status, WNOHANG) == 0) {
        if (gscl_now() > end_s)
            return false;
        usleep(2000);
    }
    return true;
}

bool check_process_run(const check_process *process, double limit_s, check_end *end, int *number) {
    int pipes[2], status = 0;
    if (pipe(pipes) != 0)
        return false;
    fflush(NULL); /* or the child writes it again */
    const double end_s = gscl_now() + limit_s;
    const pid_t child = fork();
    if (child == 0) {
        close(pipes[0]);
        prepare_child();
        const int code = process->run(process->opaque, pipes[1]);
        fflush(NULL);
        _exit(code);
    }
    close(pipes[1]);
    if (child > 0 && !(receive_records(process, pipes[0], end_s) && wait_for_end(child, end_s, &status))) {
        kill(child, SIGKILL);
        waitpid(child, &status, 0);
        *end = CHECK_TOO_LATE;
    } else {
        *end = WIFSIGNALED(status) ? CHECK_KILLED : CHECK_EXITED;
        *number = WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status);
    }
    close(pipes[0]);
    return child > 0;
}

void check_process_send(int pipe, const void *record, size_t size) {
    if (write(pipe, record, size) != (ssize_t)size)
        _exit(EXIT_FAILURE);
}
