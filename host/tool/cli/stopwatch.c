#include "cli/stopwatch.h"

#include <stdlib.h>

#include "host/system/clock.h"

double stopwatch_now(void) {
    return gscl_now();
}

static int compare_doubles(const void *a, const void *b) {
    const double *p = a, *q = b;
    return *p < *q ? -1 : *p > *q;
}

spread spread_of(double *seconds, unsigned count) {
    qsort(seconds, count, sizeof *seconds, compare_doubles);
    return (spread){seconds[count / 2], seconds[0], seconds[count - 1]};
}
