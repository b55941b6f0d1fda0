#include "runtime/stage_clock.h"

#include <math.h>

#include "host/system/clock.h"
#include "runtime/queue.h"

static gscl_stage_id change_stage(gscl_context *context, gscl_stage_id stage, bool settles) {
    gscl_stage_clock *clock = &context->clock;
    if (clock->users == 0 || clock->frozen)
        return GSCL_STAGE_NONE;
    if (settles)
        gscl_settle(context);
    double now = gscl_now();
    gscl_stage_id ended = clock->current;
    clock->sums[ended].seconds += now - clock->start_s;
    clock->sums[ended].count++;
    clock->current = stage;
    clock->start_s = now;
    return ended;
}

gscl_stage_id gscl_stage(gscl_context *context, gscl_stage_id stage) {
    return change_stage(context, stage, true);
}

gscl_stage_id gscl_short_stage(gscl_context *context, gscl_stage_id stage) {
    return change_stage(context, stage, context->timings != NULL);
}

void gscl_stages_freeze(gscl_context *context, bool frozen) {
    context->clock.frozen = frozen;
}

double gscl_remaining_s(double elapsed_s, double done) {
    const double least_s = 1e-6; /* a clock may stand still for as long */
    return done > 0 ? fmax(elapsed_s, least_s) * (1 - done) / done : INFINITY;
}
