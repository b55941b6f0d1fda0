/* Waiting for the device, which is counted. */
#ifndef GSCL_LIB_QUEUE_H
#define GSCL_LIB_QUEUE_H

#include <CL/cl.h>

#include "runtime/context.h"

/* Notes a call that enqueued work, and that waited for it where it is `blocking` and did not fail.  Returns the error. */
cl_int gscl_queue_note_work(gscl_context *context, cl_bool blocking, cl_int error);

/* Waits until the queue is empty, unless nothing was enqueued since the last wait; accepts a context without a queue. */
cl_int gscl_queue_finish(gscl_context *context);
/* The same, which only measuring asks for: it does not count for the stage. */
cl_int gscl_queue_settle(gscl_context *context);

#endif
