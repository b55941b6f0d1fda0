/* A clock. */
#ifndef GSCL_SYSTEM_CLOCK_H
#define GSCL_SYSTEM_CLOCK_H

/* Seconds on a clock that only goes forward. */
double gscl_now(void);

#endif
