/* Wall clock, and what several measurements of the same thing say. */
#ifndef GSCL_TOOL_STOPWATCH_H
#define GSCL_TOOL_STOPWATCH_H

/* Seconds of several runs. */
typedef struct spread {
    double median, fastest, slowest;
} spread;

/* Seconds on a clock that only goes forward. */
double stopwatch_now(void);

/* Sorts the seconds of `count` > 0 runs. */
spread spread_of(double *seconds, unsigned count);

#endif
