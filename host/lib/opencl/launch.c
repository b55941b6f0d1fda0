#include "opencl/launch.h"

#include <stdio.h>

#include "opencl/cl_error.h"
#include "opencl/kernel_times.h"
#include "opencl/opencl_device.h"
#include "opencl/program.h"

static gscl_result launch_fail(gscl_context *context, const gscl_launch *launch, cl_int error, const char *function) {
    char subject[64];
    snprintf(subject, sizeof subject, " of kernel %s", launch->kernel->name);
    return gscl_cl_fail(context, error, function, subject);
}

#ifndef NDEBUG
/* OpenCL itself does not notice a missing argument that an earlier launch has set. */
static gscl_result launch_check_count(gscl_context *context, const gscl_launch *launch, cl_kernel kernel) {
    cl_uint expected = 0;
    const cl_int error = gscl_cl.clGetKernelInfo(kernel, CL_KERNEL_NUM_ARGS, sizeof expected, &expected, NULL);
    if (error != CL_SUCCESS)
        return launch_fail(context, launch, error, "clGetKernelInfo");
    return launch->argument_count == expected
               ? GSCL_OK
               : gscl_fail(context, GSCL_ERROR_DEVICE_FAILED, "kernel %s takes %u arguments, it was launched with %zu",
                           launch->kernel->name, (unsigned)expected, launch->argument_count);
}
#endif

gscl_result gscl_opencl_launch(gscl_context *context, const gscl_launch *launch) {
    const cl_kernel kernel = ((const gscl_opencl_kernel *)launch->kernel)->kernel;
    const size_t global_size = launch->groups * launch->group_size;
    cl_int error = CL_SUCCESS;
#ifndef NDEBUG
    GSCL_TRY(launch_check_count(context, launch, kernel));
#endif
    for (size_t i = 0; i < launch->argument_count && error == CL_SUCCESS; i++)
        error = gscl_cl.clSetKernelArg(kernel, (cl_uint)i, launch->arguments[i].size, launch->arguments[i].value);
    if (error != CL_SUCCESS)
        return launch_fail(context, launch, error, "clSetKernelArg");
    cl_event *event = launch->timing ? gscl_opencl_time(context, launch->timing) : NULL; /* may wait */
    error = gscl_cl.clEnqueueNDRangeKernel(gscl_opencl(context)->queue, kernel, 1, NULL, &global_size,
                                           &launch->group_size, 0, NULL, event);
    return error == CL_SUCCESS ? GSCL_OK : launch_fail(context, launch, error, "clEnqueueNDRangeKernel");
}

void gscl_opencl_flush(gscl_context *context) {
    gscl_cl.clFlush(gscl_opencl(context)->queue);
}

gscl_result gscl_opencl_finish(gscl_context *context) {
    GSCL_CL(context, clFinish, gscl_opencl(context)->queue);
    return GSCL_OK;
}
