#include "opencl_faults.h"

#include "faults.h"
#include "opencl/library.h"

typedef void(CL_CALLBACK *notice)(const char *, const void *, size_t, void *);
typedef void(CL_CALLBACK *built)(cl_program, void *);

/* A call of OpenCL; `own` counts it alone. */
static bool opencl_fails(fault_kind own, const char *call) {
    const bool any = fault_fails(FAULT_OPENCL, call);
    return (own != FAULT_OPENCL && fault_fails(own, call)) || any;
}

/* The queue is in order: a call that waits has ended all copies. */
static cl_int note_copy(cl_int error, cl_bool blocking, const void *memory) {
    if (error == CL_SUCCESS && blocking)
        fault_copies_end();
    else if (error == CL_SUCCESS)
        fault_copy_begins(memory);
    return error;
}

/* The functions of the library. */
static gscl_cl_functions real;

/* Defines fail_NAME, which returns an error of its own in place of the call. */
#define WRAP(name, parameters, arguments)                                                     \
    static cl_int CL_API_CALL fail_##name parameters {                                        \
        return opencl_fails(FAULT_OPENCL, #name) ? CL_OUT_OF_RESOURCES : real.name arguments; \
    }
/* The same of a call that makes an object. */
#define WRAP_MAKER(type, name, own, parameters, arguments) \
    static type CL_API_CALL fail_##name parameters {       \
        if (!opencl_fails(own, #name))                     \
            return real.name arguments;                    \
        *error = CL_OUT_OF_RESOURCES;                      \
        return NULL;                                       \
    }

WRAP(clGetPlatformIDs, (cl_uint n, cl_platform_id *list, cl_uint *count), (n, list, count))
WRAP(clGetDeviceIDs, (cl_platform_id p, cl_device_type type, cl_uint n, cl_device_id *list, cl_uint *count),
     (p, type, n, list, count))
WRAP(clGetPlatformInfo, (cl_platform_id p, cl_platform_info what, size_t size, void *value, size_t *needed),
     (p, what, size, value, needed))
WRAP(clGetDeviceInfo, (cl_device_id d, cl_device_info what, size_t size, void *value, size_t *needed),
     (d, what, size, value, needed))
WRAP_MAKER(cl_context, clCreateContext, FAULT_OPENCL,
           (const cl_context_properties *p, cl_uint n, const cl_device_id *d, notice call, void *data, cl_int *error),
           (p, n, d, call, data, error))
WRAP_MAKER(cl_command_queue, clCreateCommandQueue, FAULT_OPENCL,
           (cl_context c, cl_device_id d, cl_command_queue_properties p, cl_int *error), (c, d, p, error))
WRAP_MAKER(cl_program, clCreateProgramWithSource, FAULT_OPENCL,
           (cl_context c, cl_uint n, const char **texts, const size_t *sizes, cl_int *error),
           (c, n, texts, sizes, error))
WRAP(clBuildProgram, (cl_program p, cl_uint n, const cl_device_id *d, const char *options, built call, void *data),
     (p, n, d, options, call, data))
WRAP_MAKER(cl_kernel, clCreateKernel, FAULT_OPENCL, (cl_program p, const char *name, cl_int *error), (p, name, error))
WRAP(clGetKernelWorkGroupInfo,
     (cl_kernel k, cl_device_id d, cl_kernel_work_group_info what, size_t size, void *value, size_t *needed),
     (k, d, what, size, value, needed))
WRAP_MAKER(cl_mem, clCreateBuffer, FAULT_BUFFER,
           (cl_context c, cl_mem_flags flags, size_t size, void *host, cl_int *error), (c, flags, size, host, error))
WRAP(clSetKernelArg, (cl_kernel k, cl_uint i, size_t size, const void *value), (k, i, size, value))
WRAP(clEnqueueNDRangeKernel,
     (cl_command_queue q, cl_kernel k, cl_uint n, const size_t *offset, const size_t *size, const size_t *group,
      cl_uint waits, const cl_event *list, cl_event *event),
     (q, k, n, offset, size, group, waits, list, event))
WRAP(clEnqueueFillBuffer,
     (cl_command_queue q, cl_mem m, const void *pattern, size_t pattern_size, size_t offset, size_t size, cl_uint waits,
      const cl_event *list, cl_event *event),
     (q, m, pattern, pattern_size, offset, size, waits, list, event))
WRAP(clEnqueueCopyBuffer,
     (cl_command_queue q, cl_mem from, cl_mem to, size_t from_offset, size_t to_offset, size_t size, cl_uint waits,
      const cl_event *list, cl_event *event),
     (q, from, to, from_offset, to_offset, size, waits, list, event))

static cl_int CL_API_CALL fail_clEnqueueReadBuffer(cl_command_queue q, cl_mem m, cl_bool blocking, size_t offset,
                                                   size_t size, void *to, cl_uint waits, const cl_event *list,
                                                   cl_event *event) {
    if (opencl_fails(FAULT_OPENCL, "clEnqueueReadBuffer"))
        return CL_OUT_OF_RESOURCES;
    return note_copy(real.clEnqueueReadBuffer(q, m, blocking, offset, size, to, waits, list, event), blocking, to);
}

static cl_int CL_API_CALL fail_clEnqueueWriteBuffer(cl_command_queue q, cl_mem m, cl_bool blocking, size_t offset,
                                                    size_t size, const void *from, cl_uint waits, const cl_event *list,
                                                    cl_event *event) {
    if (opencl_fails(FAULT_OPENCL, "clEnqueueWriteBuffer"))
        return CL_OUT_OF_RESOURCES;
    return note_copy(real.clEnqueueWriteBuffer(q, m, blocking, offset, size, from, waits, list, event), blocking, from);
}

static cl_int CL_API_CALL fail_clEnqueueReadBufferRect(cl_command_queue q, cl_mem m, cl_bool blocking,
                                                       const size_t *from, const size_t *at, const size_t *size,
                                                       size_t row, size_t slice, size_t to_row, size_t to_slice,
                                                       void *to, cl_uint waits, const cl_event *list, cl_event *event) {
    if (opencl_fails(FAULT_OPENCL, "clEnqueueReadBufferRect"))
        return CL_OUT_OF_RESOURCES;
    return note_copy(real.clEnqueueReadBufferRect(q, m, blocking, from, at, size, row, slice, to_row, to_slice, to,
                                                  waits, list, event),
                     blocking, to);
}

static cl_int CL_API_CALL fail_clFinish(cl_command_queue queue) {
    if (opencl_fails(FAULT_FINISH, "clFinish"))
        return CL_OUT_OF_RESOURCES;
    return note_copy(real.clFinish(queue), CL_TRUE, NULL);
}

void opencl_faults_install(void) {
    if (gscl_opencl_library())
        return; /* there are no devices */
    real = gscl_cl;
    gscl_cl.clGetPlatformIDs = fail_clGetPlatformIDs;
    gscl_cl.clGetDeviceIDs = fail_clGetDeviceIDs;
    gscl_cl.clGetPlatformInfo = fail_clGetPlatformInfo;
    gscl_cl.clGetDeviceInfo = fail_clGetDeviceInfo;
    gscl_cl.clCreateContext = fail_clCreateContext;
    gscl_cl.clCreateCommandQueue = fail_clCreateCommandQueue;
    gscl_cl.clCreateProgramWithSource = fail_clCreateProgramWithSource;
    gscl_cl.clBuildProgram = fail_clBuildProgram;
    gscl_cl.clCreateKernel = fail_clCreateKernel;
    gscl_cl.clGetKernelWorkGroupInfo = fail_clGetKernelWorkGroupInfo;
    gscl_cl.clCreateBuffer = fail_clCreateBuffer;
    gscl_cl.clSetKernelArg = fail_clSetKernelArg;
    gscl_cl.clEnqueueNDRangeKernel = fail_clEnqueueNDRangeKernel;
    gscl_cl.clEnqueueFillBuffer = fail_clEnqueueFillBuffer;
    gscl_cl.clEnqueueCopyBuffer = fail_clEnqueueCopyBuffer;
    gscl_cl.clEnqueueReadBuffer = fail_clEnqueueReadBuffer;
    gscl_cl.clEnqueueReadBufferRect = fail_clEnqueueReadBufferRect;
    gscl_cl.clEnqueueWriteBuffer = fail_clEnqueueWriteBuffer;
    gscl_cl.clFinish = fail_clFinish;
}
