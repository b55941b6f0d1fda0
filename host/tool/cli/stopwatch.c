#define _POSIX_C_SOURCE 200112L
#include "cli/stopwatch.h"

#include <stdlib.h>
#include <time.h>

double stopwatch_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int compare_doubles(const void *a, const void *b) {
    const double *p = a, *q = b;
    return *p < *q ? -1 : *p > *q;
}

spread spread_of(double *seconds, unsigned count) {
    qsort(seconds, count, sizeof *seconds, compare_doubles);
    return (spread){seconds[count / 2], seconds[0], seconds[count - 1]};
}
