#include "opencl/kernel_times.h"

#include <stdlib.h>

#include "opencl/library.h"
#include "opencl/opencl_device.h"
#include "runtime/queue.h"
#include "runtime/timing.h"

#define MAX_PENDING 8192 /* launches whose times are not added up yet: those of a stage of an encode */

struct gscl_kernel_times {
    size_t count;
    cl_event events[MAX_PENDING]; /* NULL: the launch failed */
    gscl_timing *timings[MAX_PENDING];
};

gscl_result gscl_opencl_times_create(gscl_context *context) {
    struct gscl_kernel_times *times = gscl_opencl(context)->times = calloc(1, sizeof *times);
    return times ? GSCL_OK : gscl_fail_memory(context);
}

void gscl_opencl_times_free(gscl_context *context) {
    free(gscl_opencl(context)->times);
    gscl_opencl(context)->times = NULL;
}

cl_event *gscl_opencl_time(gscl_context *context, gscl_timing *timing) {
    struct gscl_kernel_times *times = gscl_opencl(context)->times;
    if (times->count == MAX_PENDING)
        gscl_settle(context);
    times->events[times->count] = NULL;
    times->timings[times->count] = timing;
    return &times->events[times->count++];
}

/* Time that a kernel ran; 0 when the device reports none, as after a failure. */
static double event_seconds(cl_event event) {
    cl_ulong start = 0, end = 0; /* nanoseconds */
    if (gscl_cl.clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_START, sizeof start, &start, NULL) != CL_SUCCESS ||
        gscl_cl.clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_END, sizeof end, &end, NULL) != CL_SUCCESS)
        return 0;
    return 1e-9 * (double)(end - start);
}

void gscl_opencl_collect_times(gscl_context *context) {
    struct gscl_kernel_times *times = gscl_opencl(context)->times;
    for (size_t i = 0; times && i < times->count; i++)
        if (times->events[i]) {
            gscl_timing_add(context, times->timings[i], event_seconds(times->events[i]));
            gscl_cl.clReleaseEvent(times->events[i]);
        }
    if (times)
        times->count = 0;
}
