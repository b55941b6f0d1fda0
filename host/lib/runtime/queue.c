#include "runtime/queue.h"

/* The queue is in order: after a blocking call it is empty. */
static void note_empty(gscl_context *context) {
    context->has_work = false;
    context->waits++;
}

static void note_wait(gscl_context *context) {
    note_empty(context);
    context->clock.sums[context->clock.current].waits++;
}

cl_int gscl_queue_note_work(gscl_context *context, cl_bool blocking, cl_int error) {
    context->has_work = true;
    if (blocking && error == CL_SUCCESS)
        note_wait(context);
    return error;
}

static cl_int finish(gscl_context *context, void note(gscl_context *)) {
    if (!context->queue || !context->has_work)
        return CL_SUCCESS;
    const cl_int error = clFinish(context->queue);
    if (error == CL_SUCCESS)
        note(context);
    return error;
}

cl_int gscl_queue_finish(gscl_context *context) {
    return finish(context, note_wait);
}

cl_int gscl_queue_settle(gscl_context *context) {
    return finish(context, note_empty);
}
