/* A monotonic clock, and the spread of repeated measurements. */
#ifndef GSCL_TOOL_STOPWATCH_H
#define GSCL_TOOL_STOPWATCH_H

/* Seconds of several runs. */
typedef struct spread {
    double median, fastest, slowest;
} spread;

/* Seconds on a monotonic clock. */
double stopwatch_now(void);

/* The spread of `count` > 0 runs, whose seconds it sorts. */
spread spread_of(double *seconds, unsigned count);

#endif
