/* Loaded into the tool (LD_PRELOAD), it writes a line for each launch of a kernel and for each wait of the host for the device
 * to the file that COUNT_LAUNCHES names:
 *
 *     kernel NAME GROUPS GROUP_SIZE [LARGEST ALL]
 *     wait FUNCTION BYTES
 *
 * LARGEST and ALL, of rdo_visit: pixels of the largest box that a splat of the launch may touch, and of all.  BYTES: those that a
 * blocking call reads or writes, or 0. */
#include <CL/cl.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cl/structs.h"

typedef __typeof__(&clEnqueueNDRangeKernel) launch_function;
typedef __typeof__(&clEnqueueReadBuffer) read_function;
typedef __typeof__(&clEnqueueReadBufferRect) read_part_function;
typedef __typeof__(&clEnqueueWriteBuffer) write_function;
typedef __typeof__(&clFinish) finish_function;
typedef __typeof__(&clWaitForEvents) wait_function;
typedef __typeof__(&clGetKernelInfo) kernel_info_function;
typedef __typeof__(&clSetKernelArg) argument_function;

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

/* The first arguments of rdo_visit, as the thread has set them last: those of any kernel that takes as many bytes. */
static __thread gscl_rdo_pass pass;
static __thread cl_mem tasks;

cl_int clSetKernelArg(cl_kernel kernel, cl_uint index, size_t size, const void *value) {
    argument_function set;
    *(void **)&set = dlsym(library, "clSetKernelArg");
    if (index == 0 && size == sizeof pass)
        memcpy(&pass, value, size);
    if (index == 1 && size == sizeof tasks)
        memcpy(&tasks, value, size);
    return set(kernel, index, size, value);
}

/* Pixels of the boxes of the tasks that a launch of rdo_visit takes. */
typedef struct boxes {
    long long largest, all;
} boxes;

static boxes boxes_of(cl_command_queue queue, size_t count) {
    boxes found = {0, 0};
    gscl_rdo_task *read = malloc(count * sizeof *read);
    read_function read_buffer;
    *(void **)&read_buffer = dlsym(library, "clEnqueueReadBuffer");
    if (read && read_buffer(queue, tasks, CL_TRUE, (size_t)pass.start * sizeof *read, count * sizeof *read, read, 0,
                            NULL, NULL) == CL_SUCCESS)
        for (size_t i = 0; i < count; i++) {
            const long long pixels = (long long)(read[i].x1 - read[i].x0) * (read[i].y1 - read[i].y0);
            found.largest = pixels > found.largest ? pixels : found.largest;
            found.all += pixels;
        }
    free(read);
    return found;
}

static void count_launch(cl_command_queue queue, cl_kernel kernel, size_t items, size_t group_size) {
    char name[128] = "?";
    kernel_info_function info;
    *(void **)&info = dlsym(library, "clGetKernelInfo");
    info(kernel, CL_KERNEL_FUNCTION_NAME, sizeof name, name, NULL);
    if (file && strcmp(name, "rdo_visit") == 0) {
        const boxes found = boxes_of(queue, items / group_size);
        fprintf(file, "kernel %s %zu %zu %lld %lld\n", name, items / group_size, group_size, found.largest, found.all);
    } else if (file)
        fprintf(file, "kernel %s %zu %zu\n", name, items / group_size, group_size);
}

/* The library launches in one dimension, and names the size of the groups. */
cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t *offset,
                              const size_t *global_size, const size_t *group_size, cl_uint wait_count,
                              const cl_event *waits, cl_event *event) {
    launch_function launch;
    *(void **)&launch = dlsym(library, "clEnqueueNDRangeKernel");
    count_launch(queue, kernel, global_size[0], group_size[0]);
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
