#include "faults.h"

#include <malloc.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include "opencl/library.h"

#define MAX_PENDING 64 /* copies without waiting between two calls that wait */

typedef void(CL_CALLBACK *notice)(const char *, const void *, size_t, void *);
typedef void(CL_CALLBACK *built)(cl_program, void *);

static int counts[FAULT_KINDS];
static fault_kind failing_kind;
static int failing_number; /* 0: none */
static bool failing_forever, released_too_early;
static const char *failed_call = "";
static int live_blocks;
static uintptr_t pending[MAX_PENDING]; /* where each begins in memory */
static int pending_count;

void faults_begin(fault_kind kind, int number, bool forever) {
    for (int i = 0; i < FAULT_KINDS; i++)
        counts[i] = 0;
    failing_kind = kind;
    failing_number = number;
    failing_forever = forever;
    failed_call = "";
}

int faults_end(fault_kind kind) {
    failing_number = 0;
    return counts[kind];
}

const char *fault_call(void) {
    return failed_call;
}

bool fault_released_too_early(void) {
    const bool released = released_too_early;
    released_too_early = false;
    return released;
}

int fault_live_blocks(void) {
    return live_blocks;
}

/* Two threads of the library call at the same time while one of them builds programs (opencl/prefetch.h). */
static bool fails(fault_kind kind, const char *call) {
    const int number = __atomic_add_fetch(&counts[kind], 1, __ATOMIC_RELAXED);
    const bool failed = kind == failing_kind && failing_number > 0 &&
                        (failing_forever ? number >= failing_number : number == failing_number);
    if (failed)
        failed_call = call;
    return failed;
}

/* A call of OpenCL; `own` counts it alone. */
static bool opencl_fails(fault_kind own, const char *call) {
    const bool any = fails(FAULT_OPENCL, call);
    return (own != FAULT_OPENCL && fails(own, call)) || any;
}

/* ---- Memory ------------------------------------------------------------------------------------ */

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *memory, size_t size);
void __real_free(void *memory);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *memory, size_t size);
void __wrap_free(void *memory);

static void check_release(void *memory) {
    const uintptr_t start = (uintptr_t)memory;
    const size_t size = malloc_usable_size(memory); /* 0 for NULL */
    for (int i = 0; i < pending_count; i++)
        if (pending[i] >= start && pending[i] - start < size)
            released_too_early = true;
}

void *__wrap_malloc(size_t size) {
    void *memory = fails(FAULT_MEMORY, "malloc") ? NULL : __real_malloc(size);
    live_blocks += memory != NULL;
    return memory;
}

void *__wrap_calloc(size_t count, size_t size) {
    void *memory = fails(FAULT_MEMORY, "calloc") ? NULL : __real_calloc(count, size);
    live_blocks += memory != NULL;
    return memory;
}

void *__wrap_realloc(void *memory, size_t size) {
    if (fails(FAULT_MEMORY, "realloc"))
        return NULL;
    check_release(memory);
    void *moved = __real_realloc(memory, size);
    live_blocks += !memory && moved;
    return moved;
}

void __wrap_free(void *memory) {
    check_release(memory);
    live_blocks -= memory != NULL;
    __real_free(memory);
}

/* ---- OpenCL ------------------------------------------------------------------------------------ */

/* The queue is in order: a call that waits has ended all copies. */
static cl_int note_copy(cl_int error, cl_bool blocking, const void *memory) {
    if (error == CL_SUCCESS && blocking)
        pending_count = 0;
    else if (error == CL_SUCCESS && pending_count < MAX_PENDING)
        pending[pending_count++] = (uintptr_t)memory;
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

void faults_install(void) {
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
