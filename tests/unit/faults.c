#define _POSIX_C_SOURCE 200809L /* posix_memalign */
#include "faults.h"
#include "wrapped_allocations.h"

#include <errno.h>
#include <malloc.h>
#include <pthread.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#define MAX_PENDING 64 /* copies without waiting between two calls that wait */

static int counts[FAULT_KINDS];
static fault_kind failing_kind;
static int failing_number; /* 0: none */
static bool failing_forever, released_too_early;
static const char *failed_call = "";
static int live_blocks;
static uintptr_t pending[MAX_PENDING]; /* where each begins in memory */
static int pending_count;

void faults_begin(fault_kind kind, int number, bool forever) {
    for (int i = 0; i < FAULT_KINDS; i++)
        counts[i] = 0;
    failing_kind = kind;
    failing_number = number;
    failing_forever = forever;
    failed_call = "";
}

int faults_end(fault_kind kind) {
    failing_number = 0;
    return counts[kind];
}

const char *fault_call(void) {
    return failed_call;
}

void fault_copy_begins(const void *memory) {
    if (pending_count < MAX_PENDING)
        pending[pending_count++] = (uintptr_t)memory;
}

void fault_copies_end(void) {
    pending_count = 0;
}

bool fault_released_too_early(void) {
    const bool released = released_too_early;
    released_too_early = false;
    return released;
}

int fault_live_blocks(void) {
    return live_blocks;
}

/* Two threads of the library call at the same time while one of them builds programs (opencl/prefetch.h). */
bool fault_fails(fault_kind kind, const char *call) {
    const int number = __atomic_add_fetch(&counts[kind], 1, __ATOMIC_RELAXED);
    const bool failed = kind == failing_kind && failing_number > 0 &&
                        (failing_forever ? number >= failing_number : number == failing_number);
    if (failed)
        failed_call = call;
    return failed;
}

/* ---- Memory ------------------------------------------------------------------------------------ */

void __real_free(void *memory);
void __wrap_free(void *memory);
int __real_posix_memalign(void **memory, size_t alignment, size_t size);
int __wrap_posix_memalign(void **memory, size_t alignment, size_t size);

static void check_release(void *memory) {
    const uintptr_t start = (uintptr_t)memory;
    const size_t size = malloc_usable_size(memory); /* 0 for NULL */
    for (int i = 0; i < pending_count; i++)
        if (pending[i] >= start && pending[i] - start < size)
            released_too_early = true;
}

void *__wrap_malloc(size_t size) {
    void *memory = fault_fails(FAULT_MEMORY, "malloc") ? NULL : __real_malloc(size);
    live_blocks += memory != NULL;
    return memory;
}

void *__wrap_calloc(size_t count, size_t size) {
    void *memory = fault_fails(FAULT_MEMORY, "calloc") ? NULL : __real_calloc(count, size);
    live_blocks += memory != NULL;
    return memory;
}

void *__wrap_realloc(void *memory, size_t size) {
    if (fault_fails(FAULT_MEMORY, "realloc"))
        return NULL;
    check_release(memory);
    void *moved = __real_realloc(memory, size);
    live_blocks += !memory && moved;
    return moved;
}

void __wrap_free(void *memory) {
    check_release(memory);
    live_blocks -= memory != NULL;
    __real_free(memory);
}

int __wrap_posix_memalign(void **memory, size_t alignment, size_t size) {
    const int error =
        fault_fails(FAULT_MEMORY, "posix_memalign") ? ENOMEM : __real_posix_memalign(memory, alignment, size);
    live_blocks += error == 0;
    return error;
}

/* ---- Threads ----------------------------------------------------------------------------------- */

typedef void *thread_function(void *);

int __real_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, thread_function *run, void *argument);
int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, thread_function *run, void *argument);

int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, thread_function *run, void *argument) {
    return fault_fails(FAULT_THREAD, "pthread_create") ? EAGAIN
                                                       : __real_pthread_create(thread, attributes, run, argument);
}
