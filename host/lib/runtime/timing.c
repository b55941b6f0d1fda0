#include "runtime/timing.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "runtime/queue.h"

#define MAX_ROWS 96        /* kernels with different names; there are about 40 */
#define MAX_KERNEL_NAME 32 /* bytes, the NUL included */

struct gscl_timings {
    size_t kernel_count;
    char names[MAX_ROWS][MAX_KERNEL_NAME];
    gscl_timing kernel_rows[MAX_ROWS];
    gscl_timing listed[GSCL_STAGE_COUNT + MAX_ROWS]; /* the last result of gscl_context_timings */
};

gscl_result gscl_timing_create(gscl_context *context) {
    context->timings = calloc(1, sizeof *context->timings);
    if (!context->timings)
        return gscl_fail_memory(context);
    context->clock.users++;
    return GSCL_OK;
}

void gscl_timing_free(gscl_context *context) {
    if (!context->timings)
        return;
    gscl_settle(context);
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
    snprintf(kept, MAX_KERNEL_NAME, "%s", name);
    t->kernel_rows[t->kernel_count] = (gscl_timing){.name = kept, .is_kernel = true};
    return &t->kernel_rows[t->kernel_count++];
}

static void timing_add_items(gscl_timing *row, uint64_t items) {
    if (row->items == 0 || items < row->fewest_items)
        row->fewest_items = items;
    row->items += items;
}

gscl_timing *gscl_timing_begin(gscl_context *context, const char *kernel_name, size_t items) {
    gscl_timing *row = context->timings ? timing_row_of_name(context->timings, kernel_name) : NULL;
    if (row)
        timing_add_items(row, items);
    return row;
}

void gscl_timing_add(gscl_context *context, gscl_timing *timing, double seconds) {
    timing->seconds += seconds;
    timing->count++;
    context->clock.sums[context->clock.current].kernel_seconds += seconds;
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
    gscl_settle(context);
    memset(context->clock.sums, 0, sizeof context->clock.sums);
    for (size_t i = 0; i < context->timings->kernel_count; i++) {
        gscl_timing *row = &context->timings->kernel_rows[i];
        *row = (gscl_timing){.name = row->name, .is_kernel = true, .build_seconds = row->build_seconds};
    }
}
