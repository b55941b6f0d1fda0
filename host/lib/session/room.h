/* The state of one encode, and the services that all its stages use: effects, progress, the report.
 *
 * It may use: fit/ and lower rooms.
 *
 * In the order in which to read them:
 *   encoder.h: the state
 *   effects.h: which effects are on, and why
 *   progress.h: the progress callback
 *   encode_trace.h: times and the convergence trace
 *   tunables.h: numbers that were found by trying */
#ifndef GSCL_ROOM_LIB_SESSION_H
#define GSCL_ROOM_LIB_SESSION_H
#endif
