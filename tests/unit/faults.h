/* Faults of a test program that is linked with --wrap for malloc, calloc, realloc and free: the calls that the library makes of
 * OpenCL and for memory are counted, and chosen ones fail.  Memory that the library releases while a copy of the device
 * may still use it is detected, and blocks that it never releases are counted. */
#ifndef GSCL_TESTS_FAULTS_H
#define GSCL_TESTS_FAULTS_H

#include <stdbool.h>

typedef enum fault_kind {
    FAULT_MEMORY, /* malloc, calloc, realloc */
    FAULT_OPENCL, /* every call of OpenCL that can fail, but those that release */
    FAULT_FINISH, /* clFinish alone */
    FAULT_BUFFER, /* clCreateBuffer alone */
    FAULT_KINDS
} fault_kind;

/* Takes the place of functions of OpenCL that the library calls; to be called first. */
void faults_install(void);
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

#endif
