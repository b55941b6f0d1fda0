/* In place of pool.c and machine.c in WebAssembly, whose threads are workers that the host starts (host/web/encoder/encode-run.js).
 *
 * A module's instance has one pool.  Its caller's thread alone allocates memory, and alone writes `job`, between rounds.  No thread
 * reads `job` without a place, and none has one between rounds: one that comes counts itself as working and looks for a place then;
 * the caller takes the places away and looks then whether threads work.  Atomic operations have one order for all threads, so that
 * either the thread finds no place or the caller waits for it.  Nobody waits for a thread that has not come.
 *
 * Thread-local variables are ordinary ones here (build_encoder.py): the only one is launch_options in launch.c, into which all
 * threads of a launch write the same, and launches follow each other. */
#include <stdlib.h>

#include "native/machine.h"
#include "native/pool.h"

/* Looks at a number before a thread falls asleep: tens of microseconds.  Launches follow each other closely. */
#define AWAKE_LOOKS 20000
#define STACK_BYTES (1 << 18) /* of a thread: kernels, which do not recurse, take 45 kB */

typedef struct pool_job {
    gscl_pool_work *work;
    const void *opaque;
    size_t count, part;
    size_t next; /* first item that nobody has taken; atomic */
} pool_job;

struct gscl_pool {
    int asked; /* threads that the host was asked for; some may never come */
    /* All these are atomic. */
    int up;      /* threads that have come */
    int round;   /* of work, which threads wait for */
    int places;  /* threads that may yet join this round */
    int working; /* threads that have joined it, or look for a place */
    bool is_closing;

    pool_job job;
};

static gscl_pool only_pool;

/* Of encode-run.js: asks for a thread that calls pool_help, with the end of its stack; and the threads that this encode may use
 * now, where others run at the same time. */
__attribute__((import_module("gscl"), import_name("start"))) void host_start(char *stack);
__attribute__((import_module("gscl"), import_name("threads"))) int host_threads(void);

__attribute__((export_name("help"))) void pool_help(void);
__attribute__((export_name("close"))) void pool_close(void);

static int value_of(const int *number) {
    return __atomic_load_n(number, __ATOMIC_SEQ_CST);
}

/* Waits until a number is another. */
static void await_change(int *number, int seen) {
    for (int i = 0; i < AWAKE_LOOKS; i++)
        if (value_of(number) != seen)
            return;
    __builtin_wasm_memory_atomic_wait32(number, seen, -1);
}

static void take_parts(pool_job *job) {
    for (;;) {
        const size_t first = __atomic_fetch_add(&job->next, job->part, __ATOMIC_SEQ_CST);
        if (first >= job->count)
            return;
        job->work(job->opaque, first, job->count - first < job->part ? job->count : first + job->part);
    }
}

static bool take_place(gscl_pool *pool) {
    for (int places = value_of(&pool->places); places > 0;)
        if (__atomic_compare_exchange_n(&pool->places, &places, places - 1, false, __ATOMIC_SEQ_CST, __ATOMIC_SEQ_CST))
            return true;
    return false;
}

static void join_round(gscl_pool *pool) {
    __atomic_add_fetch(&pool->working, 1, __ATOMIC_SEQ_CST);
    if (take_place(pool))
        take_parts(&pool->job);
    if (__atomic_sub_fetch(&pool->working, 1, __ATOMIC_SEQ_CST) == 0)
        __builtin_wasm_memory_atomic_notify(&pool->working, 1);
}

/* Begins a round, or ends all, for `threads` that sleep and for those that do not. */
static void wake(gscl_pool *pool, int threads) {
    __atomic_add_fetch(&pool->round, 1, __ATOMIC_SEQ_CST);
    __builtin_wasm_memory_atomic_notify(&pool->round, (unsigned)threads);
}

void pool_help(void) {
    gscl_pool *pool = &only_pool;
    __atomic_add_fetch(&pool->up, 1, __ATOMIC_SEQ_CST);
    for (int seen = value_of(&pool->round); !__atomic_load_n(&pool->is_closing, __ATOMIC_SEQ_CST);) {
        await_change(&pool->round, seen);
        seen = value_of(&pool->round);
        join_round(pool);
    }
}

/* Lets all threads return, also those that are yet to come. */
void pool_close(void) {
    __atomic_store_n(&only_pool.is_closing, true, __ATOMIC_SEQ_CST);
    wake(&only_pool, only_pool.asked);
}

int gscl_native_thread_count(void) {
    return 1; /* unless the context says otherwise */
}

uint64_t gscl_native_memory_bytes(void) {
    return (uint64_t)1 << 32; /* addresses have 32 bits */
}

gscl_result gscl_pool_create(gscl_context *context, int threads, gscl_pool **pool) {
    (void)context, (void)threads;
    *pool = &only_pool;
    return GSCL_OK;
}

void gscl_pool_free(gscl_pool *pool) {
    (void)pool;
}

/* Asks for threads until there are `wanted`. */
static void ask_for_threads(gscl_pool *pool, int wanted) {
    while (pool->asked < wanted) {
        char *stack = malloc(STACK_BYTES);
        if (!stack)
            return;
        host_start(stack + STACK_BYTES);
        pool->asked++;
    }
}

/* Threads beside the caller's. */
static int helpers_of(gscl_pool *pool, int wanted) {
    const int allowed = host_threads(), helpers = (wanted < allowed ? wanted : allowed) - 1;
    ask_for_threads(pool, helpers);
    const int up = value_of(&pool->up);
    return helpers < up ? helpers : up;
}

static void run_shared(gscl_pool *pool, int helpers, pool_job job) {
    pool->job = job;
    __atomic_store_n(&pool->places, helpers, __ATOMIC_SEQ_CST);
    wake(pool, helpers);
    take_parts(&pool->job);
    __atomic_store_n(&pool->places, 0, __ATOMIC_SEQ_CST); /* a thread that has not woken up yet is too late */
    for (int working; (working = value_of(&pool->working)) > 0;)
        await_change(&pool->working, working);
}

int gscl_pool_run(gscl_pool *pool, int threads, size_t count, size_t part, gscl_pool_work *work, const void *opaque) {
    const pool_job job = {.work = work, .opaque = opaque, .count = count, .part = part};
    const int helpers = threads > 1 && count > part ? helpers_of(pool, threads) : 0;
    if (helpers > 0)
        run_shared(pool, helpers, job);
    else
        work(opaque, 0, count);
    return helpers > 0 ? helpers + 1 : 1;
}
