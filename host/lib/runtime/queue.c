#include "runtime/queue.h"

#include <stdlib.h>
#include <string.h>

#include "runtime/backend.h"

/* Work is in order: after a blocking call there is none. */
static void note_empty(gscl_context *context) {
    context->has_work = false;
    context->waits++;
}

static void note_wait(gscl_context *context) {
    note_empty(context);
    context->clock.sums[context->clock.current].waits++;
}

gscl_result gscl_note_work(gscl_context *context, bool blocking, gscl_result result) {
    context->has_work = true;
    if (blocking && result == GSCL_OK)
        note_wait(context);
    return result;
}

void gscl_flush(gscl_context *context) {
    if (context->has_work && context->backend->flush)
        context->backend->flush(context);
}

static gscl_result finish(gscl_context *context, void note(gscl_context *)) {
    if (!context->has_work)
        return GSCL_OK;
    GSCL_TRY(context->backend->finish(context));
    note(context);
    return GSCL_OK;
}

gscl_result gscl_finish(gscl_context *context) {
    return finish(context, note_wait);
}

/* Returns whether all work has ended, and leaves the context's message as it is. */
static bool finish_silently(gscl_context *context, void note(gscl_context *)) {
    char message[GSCL_MESSAGE_SIZE];
    memcpy(message, context->message, sizeof message);
    const bool finished = finish(context, note) == GSCL_OK;
    memcpy(context->message, message, sizeof message);
    return finished;
}

void gscl_settle(gscl_context *context) {
    finish_silently(context, note_empty);
    if (context->timings && context->device)
        context->backend->collect_times(context);
}

struct gscl_parked {
    struct gscl_parked *next;
    void *memory;
};

/* Releases all parked memory if the device has ended its work. */
static bool release_if_finished(gscl_context *context) {
    if (!finish_silently(context, note_wait))
        return false;
    while (context->parked) {
        struct gscl_parked *first = context->parked;
        context->parked = first->next;
        free(first->memory);
        free(first);
    }
    return true;
}

void gscl_release_after_copies(gscl_context *context, void *memory) {
    if (!memory)
        return;
    if (release_if_finished(context)) {
        free(memory);
        return;
    }
    struct gscl_parked *parked = malloc(sizeof *parked);
    if (!parked)
        return; /* the memory is lost, which is better than a device that writes into it after its release */
    *parked = (struct gscl_parked){context->parked, memory};
    context->parked = parked;
}

void gscl_release_parked(gscl_context *context) {
    if (release_if_finished(context))
        return;
    while (context->parked) { /* as above, the memory itself is lost */
        struct gscl_parked *next = context->parked->next;
        free(context->parked);
        context->parked = next;
    }
}
