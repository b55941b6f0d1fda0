/* Faults of a test program that is linked with --wrap for the functions of FAULT_MEMORY and FAULT_THREAD, and for free: the calls
 * that the library makes for memory, of OpenCL (opencl_faults.h) and for threads are counted, and chosen ones fail.  Memory that
 * the library releases while a copy of the device may still use it is detected, and blocks that it never releases are counted. */
#ifndef GSCL_TESTS_FAULTS_H
#define GSCL_TESTS_FAULTS_H

#include <stdbool.h>

typedef enum fault_kind {
    FAULT_MEMORY, /* malloc, calloc, realloc, posix_memalign */
    FAULT_OPENCL, /* every call of OpenCL that can fail, but those that release */
    FAULT_FINISH, /* clFinish alone */
    FAULT_BUFFER, /* clCreateBuffer alone */
    FAULT_THREAD, /* pthread_create */
    FAULT_KINDS
} fault_kind;

/* Starts to count from 0.  Call `number` of a kind fails, counted from 1, and with `forever` all after it; number 0: none
 * fails. */
void faults_begin(fault_kind kind, int number, bool forever);
/* Lets every call succeed.  Returns the number of calls of a kind since faults_begin. */
int faults_end(fault_kind kind);

/* The name of the call that failed last, "" for none. */
const char *fault_call(void);
/* Whether the library has released memory that a copy may still have used; forgets it. */
bool fault_released_too_early(void);
/* Blocks that the library has allocated and not released. */
int fault_live_blocks(void);

/* For those that take the place of functions: counts a call and returns whether it fails. */
bool fault_fails(fault_kind kind, const char *call);
/* A copy of the device uses memory from now on; all have ended. */
void fault_copy_begins(const void *memory);
void fault_copies_end(void);

#endif
