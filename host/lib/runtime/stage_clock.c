#define _POSIX_C_SOURCE 200112L
#include "runtime/stage_clock.h"

#include <math.h>

#include "runtime/queue.h"

#ifdef _WIN32
#include <windows.h>

double gscl_now(void) {
    LARGE_INTEGER ticks, frequency;
    QueryPerformanceCounter(&ticks);
    QueryPerformanceFrequency(&frequency);
    return (double)ticks.QuadPart / (double)frequency.QuadPart;
}
#else
#include <time.h>

double gscl_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
#endif

gscl_stage_id gscl_stage(gscl_context *context, gscl_stage_id stage) {
    gscl_stage_clock *clock = &context->clock;
    if (clock->users == 0 || clock->frozen)
        return GSCL_STAGE_NONE;
    gscl_settle(context);
    double now = gscl_now();
    gscl_stage_id ended = clock->current;
    clock->sums[ended].seconds += now - clock->start_s;
    clock->sums[ended].count++;
    clock->current = stage;
    clock->start_s = now;
    return ended;
}

void gscl_stages_freeze(gscl_context *context, bool frozen) {
    context->clock.frozen = frozen;
}

double gscl_remaining_s(double elapsed_s, double done) {
    const double least_s = 1e-6; /* a clock may stand still for as long */
    return done > 0 ? fmax(elapsed_s, least_s) * (1 - done) / done : INFINITY;
}
