#include "runtime/queue.h"

/* The queue is in order: after a blocking call it is empty. */
static void note_wait(gscl_context *context) {
    context->has_work = false;
    context->waits++;
    context->clock.sums[context->clock.current].waits++;
}

cl_int gscl_queue_note_work(gscl_context *context, cl_bool blocking, cl_int error) {
    context->has_work = true;
    if (blocking && error == CL_SUCCESS)
        note_wait(context);
    return error;
}

cl_int gscl_queue_finish(gscl_context *context) {
    if (!context->queue || !context->has_work)
        return CL_SUCCESS;
    const cl_int error = clFinish(context->queue);
    if (error == CL_SUCCESS)
        note_wait(context);
    return error;
}
