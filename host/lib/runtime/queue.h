/* Beginning the work of the device, and waiting for it, which is counted. */
#ifndef GSCL_LIB_QUEUE_H
#define GSCL_LIB_QUEUE_H

#include "runtime/context.h"

/* Notes a call that asked the device for work, and that waited for it where it is `blocking` and did not fail.  Returns the
 * result. */
gscl_result gscl_note_work(gscl_context *context, bool blocking, gscl_result result);

/* Has the device begin what it was asked for, which some drivers collect until the host waits: where the host has work of its own
 * next, or asks for a great deal more. */
void gscl_flush(gscl_context *context);

/* Waits until the device has ended its work; accepts a context without a device.  Where there was none since the last wait,
 * this and what waits below return at once. */
gscl_result gscl_finish(gscl_context *context);
/* The same, which only measuring asks for, and adds up the times of kernels.  It does not count for the stage, and fails
 * silently: the next call of the device reports it. */
void gscl_settle(gscl_context *context);

/* Releases memory of the host that copies without waiting may still use: after waiting for the device or, where that
 * fails, when a later call of these two can wait.  Leaves the context's message as it is.  `memory` may be NULL. */
void gscl_release_after_copies(gscl_context *context, void *memory);
/* Releases what is left of that, before the device is closed. */
void gscl_release_parked(gscl_context *context);

#endif
