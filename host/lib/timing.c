#define _POSIX_C_SOURCE 200112L
#include "timing.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "report.h"

#define MAX_ROWS 96      /* stages and kernels; there are some 60 */
#define MAX_PENDING 1024 /* events that wait to be read */
#define MAX_NAME 32

struct gscl_timings {
    gscl_timing rows[MAX_ROWS];
    cl_kernel kernels[MAX_ROWS]; /* of the rows of kernels: the first of that name */
    char names[MAX_ROWS][MAX_NAME];
    size_t count;
    gscl_timing *stage; /* under way, or NULL */
    double start_s;     /* of that stage */
    size_t pending_count;
    cl_event pending[MAX_PENDING];
    gscl_timing *pending_rows[MAX_PENDING];
};

double gscl_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

gscl_result gscl_timing_create(gscl_context *context) {
    context->timings = calloc(1, sizeof *context->timings);
    return context->timings ? GSCL_OK : gscl_fail(context, GSCL_ERROR_OUT_OF_MEMORY, "out of memory");
}

/* Reads the times of kernels that have ended, once all have. */
static void collect(gscl_context *context) {
    struct gscl_timings *t = context->timings;
    gscl_finish(context);
    for (size_t i = 0; i < t->pending_count; i++) {
        if (!t->pending[i])
            continue;                /* the launch failed */
        cl_ulong start = 0, end = 0; /* nanoseconds */
        clGetEventProfilingInfo(t->pending[i], CL_PROFILING_COMMAND_START, sizeof start, &start, NULL);
        clGetEventProfilingInfo(t->pending[i], CL_PROFILING_COMMAND_END, sizeof end, &end, NULL);
        clReleaseEvent(t->pending[i]);
        double seconds = 1e-9 * (double)(end - start);
        t->pending_rows[i]->seconds += seconds;
        t->pending_rows[i]->count++;
        if (t->stage)
            t->stage->kernel_seconds += seconds;
    }
    t->pending_count = 0;
}

void gscl_timing_free(gscl_context *context) {
    if (!context->timings)
        return;
    collect(context);
    free(context->timings);
    context->timings = NULL;
}

static gscl_timing *row_of(struct gscl_timings *t, const char *name, bool is_kernel) {
    for (size_t i = 0; i < t->count; i++)
        if (t->rows[i].is_kernel == is_kernel && strcmp(t->rows[i].name, name) == 0)
            return &t->rows[i];
    if (t->count == MAX_ROWS)
        return NULL;
    char *kept = t->names[t->count];
    snprintf(kept, MAX_NAME, "%s", name);
    t->rows[t->count] = (gscl_timing){.name = kept, .is_kernel = is_kernel};
    return &t->rows[t->count++];
}

static gscl_timing *row_of_kernel(struct gscl_timings *t, cl_kernel kernel) {
    for (size_t i = 0; i < t->count; i++)
        if (t->kernels[i] == kernel)
            return &t->rows[i];
    char name[MAX_NAME] = "";
    clGetKernelInfo(kernel, CL_KERNEL_FUNCTION_NAME, sizeof name, name, NULL);
    gscl_timing *row = row_of(t, name, true);
    if (row)
        t->kernels[row - t->rows] = kernel;
    return row;
}

const char *gscl_stage(gscl_context *context, const char *name) {
    struct gscl_timings *t = context->timings;
    if ((!t && !context->recorder) || context->stages_frozen)
        return NULL;
    gscl_finish(context);
    double now = gscl_now();
    const char *recorded = context->recorder ? gscl_recorder_stage(context->recorder, name, now) : NULL;
    if (!t)
        return recorded;
    collect(context);
    const char *ended = t->stage ? t->stage->name : NULL;
    if (t->stage) {
        t->stage->seconds += now - t->start_s;
        t->stage->count++;
    }
    t->stage = name ? row_of(t, name, false) : NULL;
    t->start_s = now;
    return ended;
}

void gscl_stages_freeze(gscl_context *context, bool frozen) {
    context->stages_frozen = frozen;
}

cl_event *gscl_timing_event(gscl_context *context, cl_kernel kernel) {
    struct gscl_timings *t = context->timings;
    if (!t)
        return NULL;
    if (t->pending_count == MAX_PENDING)
        collect(context);
    gscl_timing *row = row_of_kernel(t, kernel);
    if (!row)
        return NULL;
    t->pending[t->pending_count] = NULL;
    t->pending_rows[t->pending_count] = row;
    return &t->pending[t->pending_count++];
}

size_t gscl_context_timings(const gscl_context *context, const gscl_timing **timings) {
    if (!context || !context->timings || !timings)
        return 0;
    *timings = context->timings->rows;
    return context->timings->count;
}

double gscl_kernel_seconds(const gscl_context *context) {
    const gscl_timing *rows;
    size_t count = gscl_context_timings(context, &rows);
    double seconds = 0;
    for (size_t i = 0; i < count; i++)
        if (rows[i].is_kernel)
            seconds += rows[i].seconds;
    return seconds;
}

static int compare_samples(const void *a, const void *b) {
    const double *p = a, *q = b;
    return *p < *q ? -1 : *p > *q;
}

void gscl_sort_samples(double *samples, size_t count) {
    qsort(samples, count, sizeof *samples, compare_samples);
}

void gscl_context_reset_timings(gscl_context *context) {
    if (!context || !context->timings)
        return;
    collect(context);
    for (size_t i = 0; i < context->timings->count; i++) {
        gscl_timing *row = &context->timings->rows[i];
        *row = (gscl_timing){.name = row->name, .is_kernel = row->is_kernel};
    }
}
