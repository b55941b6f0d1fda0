#include "opencl/prefetch.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "host/system/threads.h"
#include "opencl/build_options.h"
#include "opencl/opencl_device.h"
#include "opencl/program.h"

#define MAX_MESSAGES 3 /* of a program: whether cl/builtins.h is enough, the cache, and the time that it took */

/* A program that was asked for. */
typedef struct prefetch_request {
    struct gscl_program *program; /* NULL: taken */
    size_t message_count;
    gscl_log_level levels[MAX_MESSAGES];
    char messages[MAX_MESSAGES][GSCL_MESSAGE_SIZE]; /* for the caller's log, which is not for this thread */
} prefetch_request;

struct gscl_prefetch {
    gscl_context context;      /* a copy, for the thread alone: it reports to nobody, and its messages are kept */
    gscl_opencl_device device; /* a copy, of that context */
    pthread_t thread;
    pthread_mutex_t lock; /* guards all below */
    pthread_cond_t changed;
    size_t count, done; /* programs that were asked for; those of them that were built, or not */
    bool is_ending;     /* no further program is to be built */
    prefetch_request requests[GSCL_MAX_PREFETCHED]; /* the thread has those from `done` on */
};

static void keep_message(void *opaque, gscl_log_level level, const char *text) {
    struct gscl_prefetch *p = opaque;
    prefetch_request *r = &p->requests[p->done]; /* which this thread alone changes */
    if (r->message_count == MAX_MESSAGES)
        return;
    r->levels[r->message_count] = level;
    snprintf(r->messages[r->message_count++], GSCL_MESSAGE_SIZE, "%s", text);
}

/* Waits for a program to build; NULL at the end. */
static struct gscl_program *next_program(struct gscl_prefetch *p) {
    pthread_mutex_lock(&p->lock);
    while (p->done == p->count && !p->is_ending)
        pthread_cond_wait(&p->changed, &p->lock);
    struct gscl_program *next = p->is_ending ? NULL : p->requests[p->done].program;
    pthread_mutex_unlock(&p->lock);
    return next;
}

static void note_done(struct gscl_prefetch *p) {
    pthread_mutex_lock(&p->lock);
    p->done++;
    pthread_cond_broadcast(&p->changed);
    pthread_mutex_unlock(&p->lock);
}

static void *build_programs(void *opaque) {
    struct gscl_prefetch *p = opaque;
    for (struct gscl_program *program = next_program(p); program; program = next_program(p)) {
        if (gscl_program_make(&p->context, program) != GSCL_OK)
            gscl_program_drop(program);
        note_done(p);
    }
    return NULL;
}

/* LLVM, which PoCL compiles with, gives the first thread that calls it a stack for signals. */
static void *run_thread(void *opaque) {
    return gscl_with_signal_stack(build_programs, opaque);
}

static void free_prefetch(struct gscl_prefetch *p) {
    for (size_t i = 0; i < p->count; i++)
        if (p->requests[i].program)
            gscl_program_free(p->requests[i].program);
    pthread_cond_destroy(&p->changed);
    pthread_mutex_destroy(&p->lock);
    free(p);
}

static struct gscl_prefetch *begin(const gscl_context *context) {
    struct gscl_prefetch *p = calloc(1, sizeof *p);
    if (!p)
        return NULL;
    p->context = *context;
    p->device = *gscl_opencl(context);
    p->context.device = &p->device;
    p->context.log = keep_message;
    p->context.log_opaque = p;
    p->context.build = NULL;
    pthread_mutex_init(&p->lock, NULL);
    pthread_cond_init(&p->changed, NULL);
    if (gscl_thread_start(&p->thread, run_thread, p))
        return p;
    free_prefetch(p);
    return NULL;
}

/* The place of a program among those that were asked for and not taken; -1 where it is none of them. */
static int find_requested(const struct gscl_prefetch *p, gscl_program_kind kind, const char *options) {
    for (int i = 0; p && i < (int)p->count; i++)
        if (p->requests[i].program && p->requests[i].program->kind == kind &&
            strcmp(p->requests[i].program->options, options) == 0)
            return i;
    return -1;
}

/* A program of the request; NULL where the context has or gets it, or where it cannot be created, which fails again, with a
 * message, when it is needed. */
static struct gscl_program *create_requested(gscl_context *context, const gscl_program_request *request) {
    char options[GSCL_MAX_BUILD_OPTIONS];
    struct gscl_program *program = NULL;
    const bool is_new = gscl_build_options(context, request->kind, &request->options, options) == GSCL_OK &&
                        !gscl_program_find(context, request->kind, options) &&
                        find_requested(gscl_opencl(context)->prefetch, request->kind, options) < 0;
    if (is_new && gscl_program_create(context, request->kind, options, &program) != GSCL_OK)
        program = NULL;
    gscl_forget_message(context);
    return program;
}

static void add_request(gscl_context *context, const gscl_program_request *request) {
    struct gscl_program *program = create_requested(context, request);
    if (!program)
        return;
    if (!gscl_opencl(context)->prefetch)
        gscl_opencl(context)->prefetch = begin(context);
    struct gscl_prefetch *p = gscl_opencl(context)->prefetch;
    if (!p || p->count == GSCL_MAX_PREFETCHED) {
        gscl_program_free(program);
        return;
    }
    pthread_mutex_lock(&p->lock);
    p->requests[p->count++].program = program;
    pthread_cond_broadcast(&p->changed);
    pthread_mutex_unlock(&p->lock);
}

void gscl_opencl_prefetch(gscl_context *context, const gscl_program_request *requests, size_t count) {
    for (size_t i = 0; i < count && gscl_opencl(context)->quirks->builds_aside; i++)
        add_request(context, &requests[i]);
}

/* Waits until program i was built, and tells the caller where that takes time. */
static void wait_for(gscl_context *context, size_t i) {
    struct gscl_prefetch *p = gscl_opencl(context)->prefetch;
    pthread_mutex_lock(&p->lock);
    const bool waits = p->done <= i;
    pthread_mutex_unlock(&p->lock);
    if (!waits)
        return;
    gscl_report_build(context, true);
    pthread_mutex_lock(&p->lock);
    while (p->done <= i)
        pthread_cond_wait(&p->changed, &p->lock);
    pthread_mutex_unlock(&p->lock);
    gscl_report_build(context, false);
}

/* Passes the messages of a program on, whose owner changes. */
static void hand_over(const gscl_context *context, prefetch_request *r) {
    for (size_t i = 0; i < r->message_count; i++)
        gscl_log(context, r->levels[i], "in another thread: %s", r->messages[i]);
    r->program = NULL;
}

struct gscl_program *gscl_opencl_prefetch_take(gscl_context *context, gscl_program_kind kind, const char *options) {
    struct gscl_prefetch *p = gscl_opencl(context)->prefetch;
    const int i = find_requested(p, kind, options);
    if (i < 0)
        return NULL;
    wait_for(context, (size_t)i);
    struct gscl_program *program = p->requests[i].program;
    if (!program->program)
        return NULL;
    hand_over(context, &p->requests[i]);
    return program;
}

void gscl_opencl_prefetch_end(gscl_context *context) {
    struct gscl_prefetch *p = gscl_opencl(context)->prefetch;
    if (!p)
        return;
    pthread_mutex_lock(&p->lock);
    p->is_ending = true;
    pthread_cond_broadcast(&p->changed);
    pthread_mutex_unlock(&p->lock);
    pthread_join(p->thread, NULL);
    for (size_t i = 0; i < p->done; i++)
        if (p->requests[i].program && p->requests[i].program->program) {
            gscl_program_keep(context, p->requests[i].program);
            hand_over(context, &p->requests[i]);
        }
    gscl_opencl(context)->prefetch = NULL;
    free_prefetch(p);
}
