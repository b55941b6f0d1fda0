/* The OpenCL library of the machine, which is opened when devices are first listed: libgscl runs without it. */
#ifndef GSCL_LIB_OPENCL_LIBRARY_H
#define GSCL_LIB_OPENCL_LIBRARY_H

#include <CL/cl.h>

/* All functions of OpenCL that this room calls: DO(clFinish) and so on. */
#define GSCL_CL_FUNCTIONS(DO)     \
    DO(clBuildProgram)            \
    DO(clCreateBuffer)            \
    DO(clCreateCommandQueue)      \
    DO(clCreateContext)           \
    DO(clCreateKernel)            \
    DO(clCreateProgramWithBinary) \
    DO(clCreateProgramWithSource) \
    DO(clEnqueueCopyBuffer)       \
    DO(clEnqueueFillBuffer)       \
    DO(clEnqueueMapBuffer)        \
    DO(clEnqueueNDRangeKernel)    \
    DO(clEnqueueReadBuffer)       \
    DO(clEnqueueReadBufferRect)   \
    DO(clEnqueueUnmapMemObject)   \
    DO(clEnqueueWriteBuffer)      \
    DO(clFinish)                  \
    DO(clFlush)                   \
    DO(clGetDeviceIDs)            \
    DO(clGetDeviceInfo)           \
    DO(clGetEventProfilingInfo)   \
    DO(clGetKernelInfo)           \
    DO(clGetKernelWorkGroupInfo)  \
    DO(clGetPlatformIDs)          \
    DO(clGetPlatformInfo)         \
    DO(clGetProgramBuildInfo)     \
    DO(clGetProgramInfo)          \
    DO(clReleaseCommandQueue)     \
    DO(clReleaseContext)          \
    DO(clReleaseEvent)            \
    DO(clReleaseKernel)           \
    DO(clReleaseMemObject)        \
    DO(clReleaseProgram)          \
    DO(clRetainProgram)           \
    DO(clSetKernelArg)            \
    DO(clWaitForEvents)

/* Their addresses, once gscl_opencl_library has returned NULL; a test may put others in their place. */
#define GSCL_CL_POINTER(function) __typeof__ (&(function))(function);
typedef struct gscl_cl_functions {
    GSCL_CL_FUNCTIONS(GSCL_CL_POINTER)
} gscl_cl_functions;
#undef GSCL_CL_POINTER

extern gscl_cl_functions gscl_cl;

/* Opens the library, the first time.  Returns NULL, or why there is none: "libOpenCL.so.1: cannot open ...".  Any threads may
 * call it at the same time. */
const char *gscl_opencl_library(void);

#endif
