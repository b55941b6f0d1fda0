/* A function that runs in a process of its own and reports records of one size to its parent. */
#ifndef GSCL_SYSTEM_CHECK_PROCESS_H
#define GSCL_SYSTEM_CHECK_PROCESS_H

#include <stdbool.h>
#include <stddef.h>

#define CHECK_MAX_RECORD 512 /* bytes, which a pipe takes whole */

typedef struct check_process {
    int (*run)(void *opaque, int pipe); /* in the child: writes records to the pipe and returns its exit code */
    size_t record_size;                 /* at most CHECK_MAX_RECORD */
    void (*receive)(void *opaque, const void *record); /* in the parent, for each record */
    void *opaque;                                      /* first argument of both; a copy in the child */
} check_process;

typedef enum check_end {
    CHECK_EXITED,  /* *number is the exit code */
    CHECK_KILLED,  /* by the signal *number */
    CHECK_TOO_LATE /* it was ended after the time limit */
} check_end;

/* Runs the process to its end, at most limit_s seconds.  Returns false when no process could be started. */
bool check_process_run(const check_process *process, double limit_s, check_end *end, int *number);

/* In the child: sends a record. */
void check_process_send(int pipe, const void *record, size_t size);

#endif
