#include "runtime/timing.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "runtime/cl_names.h"
#include "runtime/queue.h"

#define MAX_ROWS 96      /* kernels with different names; there are about 40 */
#define MAX_PENDING 8192 /* launches whose times are not added up yet: those of a stage of an encode */

struct gscl_timings {
    size_t kernel_count;
    cl_kernel kernels[MAX_ROWS]; /* the first kernel of each name */
    char names[MAX_ROWS][GSCL_MAX_KERNEL_NAME];
    gscl_timing kernel_rows[MAX_ROWS];
    size_t pending_count;
    cl_event pending[MAX_PENDING];
    gscl_timing *pending_rows[MAX_PENDING];
    gscl_timing listed[GSCL_STAGE_COUNT + MAX_ROWS]; /* the last result of gscl_context_timings */
};

gscl_result gscl_timing_create(gscl_context *context) {
    context->timings = calloc(1, sizeof *context->timings);
    if (!context->timings)
        return gscl_fail_memory(context);
    context->clock.users++;
    return GSCL_OK;
}

/* Time that a kernel ran; 0 when the device reports none, as after a failure. */
static double event_seconds(cl_event event) {
    cl_ulong start = 0, end = 0; /* nanoseconds */
    const cl_int error = clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_START, sizeof start, &start, NULL);
    if (error != CL_SUCCESS ||
        clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_END, sizeof end, &end, NULL) != CL_SUCCESS)
        return 0;
    return 1e-9 * (double)(end - start);
}

/* Waits until all kernels have ended and adds up their times. */
static void timing_collect(gscl_context *context) {
    struct gscl_timings *t = context->timings;
    gscl_queue_settle(context); /* the next checked call reports a failure */
    for (size_t i = 0; i < t->pending_count; i++) {
        if (!t->pending[i])
            continue; /* the launch failed */
        const double seconds = event_seconds(t->pending[i]);
        clReleaseEvent(t->pending[i]);
        t->pending_rows[i]->seconds += seconds;
        t->pending_rows[i]->count++;
        context->clock.sums[context->clock.current].kernel_seconds += seconds;
    }
    t->pending_count = 0;
}

void gscl_timing_free(gscl_context *context) {
    if (!context->timings)
        return;
    timing_collect(context);
    free(context->timings);
    context->timings = NULL;
}

static gscl_timing *timing_row_of_name(struct gscl_timings *t, const char *name) {
    for (size_t i = 0; i < t->kernel_count; i++)
        if (strcmp(t->names[i], name) == 0)
            return &t->kernel_rows[i];
    if (t->kernel_count == MAX_ROWS)
        return NULL;
    char *kept = t->names[t->kernel_count];
    snprintf(kept, GSCL_MAX_KERNEL_NAME, "%s", name);
    t->kernel_rows[t->kernel_count] = (gscl_timing){.name = kept, .is_kernel = true};
    return &t->kernel_rows[t->kernel_count++];
}

static gscl_timing *timing_row_of_kernel(struct gscl_timings *t, cl_kernel kernel) {
    for (size_t i = 0; i < t->kernel_count; i++)
        if (t->kernels[i] == kernel)
            return &t->kernel_rows[i];
    char name[GSCL_MAX_KERNEL_NAME];
    gscl_kernel_name(kernel, name);
    gscl_timing *row = timing_row_of_name(t, name);
    if (row)
        t->kernels[row - t->kernel_rows] = kernel;
    return row;
}

void gscl_timing_settle(gscl_context *context) {
    if (context->timings)
        timing_collect(context);
    else
        gscl_queue_settle(context);
}

static void timing_add_items(gscl_timing *row, uint64_t items) {
    if (row->items == 0 || items < row->fewest_items)
        row->fewest_items = items;
    row->items += items;
}

cl_event *gscl_timing_event(gscl_context *context, cl_kernel kernel, size_t items) {
    struct gscl_timings *t = context->timings;
    if (!t)
        return NULL;
    if (t->pending_count == MAX_PENDING)
        timing_collect(context);
    gscl_timing *row = timing_row_of_kernel(t, kernel);
    if (!row)
        return NULL;
    timing_add_items(row, items);
    t->pending[t->pending_count] = NULL;
    t->pending_rows[t->pending_count] = row;
    return &t->pending[t->pending_count++];
}

void gscl_timing_add_build(gscl_context *context, cl_kernel kernel, double seconds) {
    gscl_timing *row = context->timings ? timing_row_of_kernel(context->timings, kernel) : NULL;
    if (row)
        row->build_seconds += seconds;
}

const gscl_timing *gscl_context_timings(const gscl_context *context) {
    if (!context || !context->timings)
        return NULL;
    struct gscl_timings *t = context->timings;
    size_t count = 0;
    for (int stage = GSCL_STAGE_NONE + 1; stage < GSCL_STAGE_COUNT; stage++) {
        const gscl_stage_time_sum *sum = &context->clock.sums[stage];
        if (sum->count > 0)
            t->listed[count++] = (gscl_timing){.name = gscl_stage_name((gscl_stage_id)stage),
                                               .count = sum->count,
                                               .seconds = sum->seconds,
                                               .kernel_seconds = sum->kernel_seconds,
                                               .waits = sum->waits};
    }
    for (size_t i = 0; i < t->kernel_count; i++)
        t->listed[count++] = t->kernel_rows[i];
    for (size_t i = 0; i < count; i++)
        t->listed[i].next = i + 1 < count ? &t->listed[i + 1] : NULL;
    return count > 0 ? t->listed : NULL;
}

double gscl_kernel_seconds(const gscl_context *context) {
    double seconds = 0;
    for (size_t i = 0; context->timings && i < context->timings->kernel_count; i++)
        seconds += context->timings->kernel_rows[i].seconds;
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
    timing_collect(context);
    memset(context->clock.sums, 0, sizeof context->clock.sums);
    for (size_t i = 0; i < context->timings->kernel_count; i++) {
        gscl_timing *row = &context->timings->kernel_rows[i];
        *row = (gscl_timing){.name = row->name, .is_kernel = true, .build_seconds = row->build_seconds};
    }
}
