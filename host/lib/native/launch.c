#include "native/launch.h"

#include <stdlib.h>

#include "host/system/clock.h"
#include "native/native_device.h"
#include "native/tunables.h"
#include "runtime/timing.h"

#define MAX_ARGUMENTS 24 /* of a kernel */

bool gscl_native_all_threads;

/* The options of the launch that this thread works on (cl/options.h). */
static __thread const gscl_native_options *launch_options;

/* Called by general kernels. */
const gscl_native_options *gscl_launch_options(void);
const gscl_native_options *gscl_launch_options(void) {
    return launch_options;
}

/* Options that no kernel is compiled for: other precision than that of an encode. */
static bool is_of_measuring(const gscl_kernel_options *o) {
    return o->is_double || o->exponential || o->support > 0 || o->early_stop > 0;
}

static gscl_result keep(gscl_context *context, const gscl_native_kernel *compiled, gscl_native_options options,
                        gscl_kernel **kernel) {
    gscl_kept_kernel *kept = malloc(sizeof *kept);
    if (!kept)
        return gscl_fail_memory(context);
    *kept = (gscl_kept_kernel){.base = {.name = compiled->name},
                               .next = gscl_native(context)->kernels,
                               .compiled = compiled,
                               .options = options};
    gscl_native(context)->kernels = kept;
    *kernel = &kept->base;
    return GSCL_OK;
}

gscl_result gscl_native_kernel_find(gscl_context *context, gscl_program_kind kind, const gscl_kernel_options *options,
                                    const char *name, gscl_kernel **kernel) {
    const gscl_native_kernel *compiled =
        is_of_measuring(options) ? NULL : gscl_native_find(gscl_native(context)->processor, kind, options, name);
    const gscl_native_options own = gscl_native_options_of(options);
    if (!compiled)
        return gscl_fail(context, GSCL_ERROR_KERNEL_BUILD,
                         "kernels of another precision need an OpenCL device, which compiles them; the device "
                         "\"host\" has none (kernel %s)",
                         name);
    for (gscl_kept_kernel *kept = gscl_native(context)->kernels; kept; kept = kept->next)
        if (kept->compiled == compiled && gscl_native_options_equal(&kept->options, &own)) {
            *kernel = &kept->base;
            return GSCL_OK;
        }
    return keep(context, compiled, own, kernel);
}

void gscl_native_kernels_free(gscl_context *context) {
    while (gscl_native(context)->kernels) {
        gscl_kept_kernel *next = gscl_native(context)->kernels->next;
        free(gscl_native(context)->kernels);
        gscl_native(context)->kernels = next;
    }
}

/* What the threads of a launch share. */
typedef struct shared_launch {
    const gscl_kept_kernel *kernel;
    const void *arguments[MAX_ARGUMENTS];
} shared_launch;

static void run_items(const void *opaque, size_t first, size_t end) {
    const shared_launch *launch = opaque;
    launch_options = &launch->kernel->options;
    launch->kernel->compiled->function(launch->arguments, first, end);
}

/* Threads that a launch is worth: waking one takes as long as gscl_native_tunables.thread_s of work. */
static int threads_for(const gscl_native_device *device, const gscl_kept_kernel *kernel, size_t items) {
    const double wanted = kernel->item_s * (double)items / gscl_native_tunables.thread_s;
    if (gscl_native_all_threads || wanted >= device->threads)
        return device->threads;
    return wanted < 1 ? 1 : (int)wanted;
}

/* Notes what a work-item took on one thread, as a mean over launches that follows changes. */
static void note_time(gscl_kept_kernel *kernel, double seconds, int threads, size_t items) {
    const double item_s = seconds * threads / (double)items;
    kernel->item_s = kernel->item_s > 0 ? 0.75 * kernel->item_s + 0.25 * item_s : item_s;
}

gscl_result gscl_native_launch(gscl_context *context, const gscl_launch *launch) {
    gscl_native_device *device = gscl_native(context);
    gscl_kept_kernel *kernel = (gscl_kept_kernel *)launch->kernel;
    const size_t items = launch->groups * launch->group_size; /* a group has one work-item (cl/native.h) */
    if (launch->argument_count != kernel->compiled->argument_count || launch->argument_count > MAX_ARGUMENTS)
        return gscl_fail(context, GSCL_ERROR_DEVICE_FAILED, "kernel %s takes %zu arguments, it was launched with %zu",
                         kernel->base.name, kernel->compiled->argument_count, launch->argument_count);
    shared_launch shared = {.kernel = kernel};
    for (size_t i = 0; i < launch->argument_count; i++)
        shared.arguments[i] = launch->arguments[i].value;
    const int threads = threads_for(device, kernel, items);
    const size_t parts = (size_t)threads * (size_t)gscl_native_tunables.parts;
    const double start_s = gscl_now();
    const int used = gscl_pool_run(device->pool, threads, items, (items + parts - 1) / parts, run_items, &shared);
    const double seconds = gscl_now() - start_s;
    note_time(kernel, seconds, used, items);
    if (launch->timing)
        gscl_timing_add(context, launch->timing, seconds);
    return GSCL_OK;
}
