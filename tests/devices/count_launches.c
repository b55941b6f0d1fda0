/* Loaded into the tool (LD_PRELOAD), it writes a line for each launch of a kernel and for each wait of the host for the device
 * to the file that COUNT_LAUNCHES names:
 *
 *     kernel NAME GROUPS GROUP_SIZE
 *     wait FUNCTION BYTES
 *
 * BYTES: those that a blocking call reads or writes, or 0. */
#include <CL/cl.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>

typedef __typeof__(&clEnqueueNDRangeKernel) launch_function;
typedef __typeof__(&clEnqueueReadBuffer) read_function;
typedef __typeof__(&clEnqueueReadBufferRect) read_part_function;
typedef __typeof__(&clEnqueueWriteBuffer) write_function;
typedef __typeof__(&clFinish) finish_function;
typedef __typeof__(&clWaitForEvents) wait_function;
typedef __typeof__(&clGetKernelInfo) kernel_info_function;

static void *library;
static FILE *file;

/* Adds OpenCL to the functions of the process, where libgscl looks for them first and meets those below. */
__attribute__((constructor)) static void begin(void) {
    const char *path = getenv("COUNT_LAUNCHES");
    library = dlopen("libOpenCL.so.1", RTLD_LAZY | RTLD_GLOBAL);
    if (path && *path)
        file = fopen(path, "a");
}

__attribute__((destructor)) static void end(void) {
    if (file)
        fclose(file);
}

/* One call of fprintf, which holds the file's lock, so that lines of several threads stay whole. */
static void count_wait(const char *function, size_t bytes) {
    if (file)
        fprintf(file, "wait %s %zu\n", function, bytes);
}

static void count_launch(cl_kernel kernel, size_t items, size_t group_size) {
    char name[128] = "?";
    kernel_info_function info;
    *(void **)&info = dlsym(library, "clGetKernelInfo");
    info(kernel, CL_KERNEL_FUNCTION_NAME, sizeof name, name, NULL);
    if (file)
        fprintf(file, "kernel %s %zu %zu\n", name, items / group_size, group_size);
}

/* The library launches in one dimension, and names the size of the groups. */
cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t *offset,
                              const size_t *global_size, const size_t *group_size, cl_uint wait_count,
                              const cl_event *waits, cl_event *event) {
    launch_function launch;
    *(void **)&launch = dlsym(library, "clEnqueueNDRangeKernel");
    count_launch(kernel, global_size[0], group_size[0]);
    return launch(queue, kernel, dimensions, offset, global_size, group_size, wait_count, waits, event);
}

cl_int clEnqueueReadBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset, size_t size,
                           void *data, cl_uint wait_count, const cl_event *waits, cl_event *event) {
    read_function read;
    *(void **)&read = dlsym(library, "clEnqueueReadBuffer");
    if (blocking)
        count_wait("clEnqueueReadBuffer", size);
    return read(queue, buffer, blocking, offset, size, data, wait_count, waits, event);
}

cl_int clEnqueueReadBufferRect(cl_command_queue queue, cl_mem buffer, cl_bool blocking, const size_t *buffer_origin,
                               const size_t *host_origin, const size_t *region, size_t buffer_row, size_t buffer_slice,
                               size_t host_row, size_t host_slice, void *data, cl_uint wait_count,
                               const cl_event *waits, cl_event *event) {
    read_part_function read;
    *(void **)&read = dlsym(library, "clEnqueueReadBufferRect");
    if (blocking)
        count_wait("clEnqueueReadBufferRect", region[0] * region[1] * region[2]);
    return read(queue, buffer, blocking, buffer_origin, host_origin, region, buffer_row, buffer_slice, host_row,
                host_slice, data, wait_count, waits, event);
}

cl_int clEnqueueWriteBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset, size_t size,
                            const void *data, cl_uint wait_count, const cl_event *waits, cl_event *event) {
    write_function write;
    *(void **)&write = dlsym(library, "clEnqueueWriteBuffer");
    if (blocking)
        count_wait("clEnqueueWriteBuffer", size);
    return write(queue, buffer, blocking, offset, size, data, wait_count, waits, event);
}

cl_int clFinish(cl_command_queue queue) {
    finish_function finish;
    *(void **)&finish = dlsym(library, "clFinish");
    count_wait("clFinish", 0);
    return finish(queue);
}

cl_int clWaitForEvents(cl_uint count, const cl_event *events) {
    wait_function wait;
    *(void **)&wait = dlsym(library, "clWaitForEvents");
    count_wait("clWaitForEvents", 0);
    return wait(count, events);
}
