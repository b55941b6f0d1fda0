#include "runtime/launch.h"

#include "host/system/clock.h"
#include "runtime/queue.h"
#include "runtime/timing.h"

gscl_result gscl_kernel_find(gscl_context *context, gscl_program_kind kind, const gscl_kernel_options *options,
                             const char *name, gscl_kernel **kernel) {
    return context->backend->kernel_find(context, kind, options, name, kernel);
}

/* Launches a kernel and waits, because the launch may build the kernel. */
static gscl_result launch_and_wait(gscl_context *context, const gscl_launch *launch) {
    const double start_s = gscl_now();
    gscl_report_build(context, true);
    gscl_result result = gscl_note_work(context, false, context->backend->launch(context, launch));
    if (result == GSCL_OK)
        result = gscl_finish(context);
    if (launch->timing)
        launch->timing->build_seconds += gscl_now() - start_s;
    gscl_report_build(context, false);
    return result;
}

gscl_result gscl_launch_(gscl_context *context, gscl_kernel *kernel, size_t groups, size_t group_size,
                         const gscl_argument *arguments, size_t count) {
    if (groups == 0)
        return GSCL_OK;
    const gscl_launch launch = {kernel,    groups, group_size,
                                arguments, count,  gscl_timing_begin(context, kernel->name, groups * group_size)};
    const bool may_build = kernel->may_build && (context->build || context->timings);
    if (may_build)
        kernel->may_build = false;
    return may_build ? launch_and_wait(context, &launch)
                     : gscl_note_work(context, false, context->backend->launch(context, &launch));
}

void gscl_prefetch(gscl_context *context, const gscl_program_request *requests, size_t count) {
    context->backend->prefetch(context, requests, count);
}

void gscl_prefetch_end(gscl_context *context) {
    context->backend->prefetch_end(context);
}
