#define _POSIX_C_SOURCE 200809L
#include "native/pool.h"

#include <pthread.h>
#include <stdlib.h>
#include <sys/types.h>
#include <unistd.h>

#include "host/system/clock.h"
#include "host/system/threads.h"
#include "native/machine.h"
#include "native/tunables.h"

/* One piece of work that threads share: each takes the next part until none is left. */
typedef struct pool_job {
    gscl_pool_work *work;
    const void *opaque;
    size_t count, part;
    size_t next; /* first item that nobody has taken; atomic */
} pool_job;

struct gscl_pool {
    pthread_mutex_t lock;
    pthread_cond_t begin, end;
    int thread_count; /* those that run may be fewer, the caller's is not among them */
    double awake_s;   /* seconds for which a thread waits before it falls asleep */
    int started;      /* threads; those that could not be started are not tried again */
    bool is_closing;
    pid_t process;  /* whose threads these are: a fork has none of them */
    unsigned round; /* of work, which threads wait for; atomic */
    int places;     /* threads that may yet join this round */
    int working;    /* threads that have joined it and not ended; atomic */
    pool_job job;
    pthread_t threads[];
};

/* Pools of this process that do work now. */
static int busy_pools;

static void take_parts(pool_job *job) {
    for (;;) {
        const size_t first = __atomic_fetch_add(&job->next, job->part, __ATOMIC_RELAXED);
        if (first >= job->count)
            return;
        job->work(job->opaque, first, job->count - first < job->part ? job->count : first + job->part);
    }
}

/* Whether a thread that waits since `start_s` stays awake: launches follow each other so closely that one which falls asleep
 * at once is woken up most of the time.  Where other pools are at work, they need its processor. */
static bool stays_awake(const gscl_pool *pool, double start_s) {
    return __atomic_load_n(&busy_pools, __ATOMIC_RELAXED) <= 1 && gscl_now() < start_s + pool->awake_s;
}

/* Waits for a round other than `seen`, with the lock held before and after. */
static void await_round(gscl_pool *pool, unsigned seen) {
    const double start_s = gscl_now();
    pthread_mutex_unlock(&pool->lock);
    while (__atomic_load_n(&pool->round, __ATOMIC_RELAXED) == seen && stays_awake(pool, start_s))
        ;
    pthread_mutex_lock(&pool->lock);
    while (pool->round == seen && !pool->is_closing)
        pthread_cond_wait(&pool->begin, &pool->lock);
}

/* Waits until all threads have ended their work, with the lock held before and after. */
static void await_end(gscl_pool *pool) {
    const double start_s = gscl_now();
    pthread_mutex_unlock(&pool->lock);
    while (__atomic_load_n(&pool->working, __ATOMIC_RELAXED) > 0 && stays_awake(pool, start_s))
        ;
    pthread_mutex_lock(&pool->lock);
    while (pool->working > 0)
        pthread_cond_wait(&pool->end, &pool->lock);
}

static void *run_thread(void *opaque) {
    gscl_pool *pool = opaque;
    unsigned seen = 0;
    pthread_mutex_lock(&pool->lock);
    while (!pool->is_closing) {
        if (pool->round == seen) {
            await_round(pool, seen);
            continue;
        }
        seen = pool->round;
        if (pool->places == 0)
            continue;
        pool->places--;
        __atomic_add_fetch(&pool->working, 1, __ATOMIC_RELAXED);
        pthread_mutex_unlock(&pool->lock);
        take_parts(&pool->job);
        pthread_mutex_lock(&pool->lock);
        if (__atomic_sub_fetch(&pool->working, 1, __ATOMIC_RELAXED) == 0)
            pthread_cond_signal(&pool->end);
    }
    pthread_mutex_unlock(&pool->lock);
    return NULL;
}

gscl_result gscl_pool_create(gscl_context *context, int threads, gscl_pool **pool) {
    gscl_pool *p = *pool = calloc(1, sizeof *p + (size_t)threads * sizeof(pthread_t));
    if (!p)
        return gscl_fail_memory(context);
    p->thread_count = threads - 1;
    p->awake_s = threads <= gscl_native_thread_count() ? gscl_native_tunables.awake_s : 0;
    p->process = getpid();
    pthread_mutex_init(&p->lock, NULL);
    pthread_cond_init(&p->begin, NULL);
    pthread_cond_init(&p->end, NULL);
    return GSCL_OK;
}

void gscl_pool_free(gscl_pool *pool) {
    if (!pool)
        return;
    if (pool->process != getpid()) { /* nothing to wait for; the lock may be held for ever */
        free(pool);
        return;
    }
    pthread_mutex_lock(&pool->lock);
    pool->is_closing = true;
    pthread_cond_broadcast(&pool->begin);
    pthread_mutex_unlock(&pool->lock);
    for (int i = 0; i < pool->started; i++)
        pthread_join(pool->threads[i], NULL);
    pthread_cond_destroy(&pool->begin);
    pthread_cond_destroy(&pool->end);
    pthread_mutex_destroy(&pool->lock);
    free(pool);
}

/* Starts threads until there are `wanted`. */
static void start_threads(gscl_pool *pool, int wanted) {
    while (pool->started < wanted) {
        if (!gscl_thread_start(&pool->threads[pool->started], run_thread, pool)) {
            pool->thread_count = pool->started;
            break;
        }
        pool->started++;
    }
}

/* Threads beside the caller's: at most `wanted`, and fewer where other pools are at work. */
static int helpers_of(const gscl_pool *pool, int wanted, int busy) {
    const int free_threads = (pool->thread_count + 1) / busy;
    const int threads = wanted < free_threads ? wanted : free_threads;
    return threads > pool->thread_count ? pool->thread_count : threads < 1 ? 0 : threads - 1;
}

/* Returns the number of threads beside the caller's. */
static int run_shared(gscl_pool *pool, int helpers, pool_job job) {
    pthread_mutex_lock(&pool->lock);
    start_threads(pool, helpers);
    pool->job = job;
    helpers = helpers < pool->started ? helpers : pool->started;
    pool->places = helpers;
    __atomic_add_fetch(&pool->round, 1, __ATOMIC_RELAXED);
    pthread_cond_broadcast(&pool->begin);
    pthread_mutex_unlock(&pool->lock);
    take_parts(&pool->job);
    pthread_mutex_lock(&pool->lock);
    pool->places = 0; /* a thread that has not woken up yet is too late */
    if (pool->working > 0)
        await_end(pool);
    pthread_mutex_unlock(&pool->lock);
    return helpers;
}

int gscl_pool_run(gscl_pool *pool, int threads, size_t count, size_t part, gscl_pool_work *work, const void *opaque) {
    const pool_job job = {.work = work, .opaque = opaque, .count = count, .part = part};
    const int busy = __atomic_add_fetch(&busy_pools, 1, __ATOMIC_RELAXED);
    int helpers = count > part ? helpers_of(pool, threads, busy) : 0;
    if (helpers > 0 && pool->process != getpid())
        helpers = 0;
    if (helpers > 0)
        helpers = run_shared(pool, helpers, job);
    else
        work(opaque, 0, count);
    __atomic_sub_fetch(&busy_pools, 1, __ATOMIC_RELAXED);
    return helpers + 1;
}
