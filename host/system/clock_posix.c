#define _POSIX_C_SOURCE 200112L
#include "host/system/clock.h"

#include <time.h>

double gscl_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
