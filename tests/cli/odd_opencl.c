/* Loaded into the tool (LD_PRELOAD), it stands for OpenCL implementations that are broken in one way, which ODD_OPENCL
 * names:
 *   slow-build  the first program takes longer to build than the tool stays silent
 *   refuse      no device but the first one gets a context
 *   crash       the first launch of a kernel ends the process
 *   hang        the first launch of a kernel never returns
 *   wrong       one sample of the picture of gscl devices --check is wrong
 *   no-memory   kernels cannot be launched
 *   gpu         all devices say that they are GPUs */
#define _DEFAULT_SOURCE /* usleep */
#include <CL/cl.h>
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define CHECKED_SIZE (96 * 64 * 3 * sizeof(float)) /* of that picture */

typedef cl_int build_function(cl_program, cl_uint, const cl_device_id *, const char *,
                              void(CL_CALLBACK *)(cl_program, void *), void *);
typedef cl_context context_function(const cl_context_properties *, cl_uint, const cl_device_id *,
                                    void(CL_CALLBACK *)(const char *, const void *, size_t, void *), void *, cl_int *);
typedef cl_int device_ids_function(cl_platform_id, cl_device_type, cl_uint, cl_device_id *, cl_uint *);
typedef cl_int info_function(cl_device_id, cl_device_info, size_t, void *, size_t *);
typedef cl_int launch_function(cl_command_queue, cl_kernel, cl_uint, const size_t *, const size_t *, const size_t *,
                               cl_uint, const cl_event *, cl_event *);
typedef cl_int read_function(cl_command_queue, cl_mem, cl_bool, size_t, size_t, void *, cl_uint, const cl_event *,
                             cl_event *);

static void *library;

/* Adds OpenCL to the functions of the process, where libgscl looks for them first and meets those below. */
__attribute__((constructor)) static void open_library(void) {
    library = dlopen("libOpenCL.so.1", RTLD_LAZY | RTLD_GLOBAL);
}

static int is_odd(const char *way) {
    const char *chosen = getenv("ODD_OPENCL");
    return chosen && strcmp(chosen, way) == 0;
}

cl_int clBuildProgram(cl_program program, cl_uint count, const cl_device_id *devices, const char *options,
                      void(CL_CALLBACK *notify)(cl_program, void *), void *data) {
    static int was_slow;
    build_function *build;
    *(void **)&build = dlsym(library, "clBuildProgram");
    if (is_odd("slow-build") && !was_slow++)
        usleep(1200000);
    return build(program, count, devices, options, notify, data);
}

cl_int clGetDeviceInfo(cl_device_id device, cl_device_info name, size_t capacity, void *value, size_t *size) {
    info_function *get;
    *(void **)&get = dlsym(library, "clGetDeviceInfo");
    const cl_int error = get(device, name, capacity, value, size);
    if (is_odd("gpu") && name == CL_DEVICE_TYPE && error == CL_SUCCESS && value)
        *(cl_device_type *)value = CL_DEVICE_TYPE_GPU;
    return error;
}

static cl_device_id first_device;

cl_int clGetDeviceIDs(cl_platform_id platform, cl_device_type type, cl_uint capacity, cl_device_id *devices,
                      cl_uint *count) {
    device_ids_function *get;
    *(void **)&get = dlsym(library, "clGetDeviceIDs");
    const cl_int error = get(platform, type, capacity, devices, count);
    if (error == CL_SUCCESS && devices && !first_device)
        first_device = devices[0];
    return error;
}

cl_context clCreateContext(const cl_context_properties *properties, cl_uint count, const cl_device_id *devices,
                           void(CL_CALLBACK *notify)(const char *, const void *, size_t, void *), void *data,
                           cl_int *error) {
    context_function *create;
    *(void **)&create = dlsym(library, "clCreateContext");
    if (is_odd("refuse") && devices[0] != first_device) {
        *error = CL_OUT_OF_RESOURCES;
        return NULL;
    }
    return create(properties, count, devices, notify, data, error);
}

cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t *offset,
                              const size_t *global_size, const size_t *group_size, cl_uint wait_count,
                              const cl_event *waits, cl_event *event) {
    launch_function *launch;
    *(void **)&launch = dlsym(library, "clEnqueueNDRangeKernel");
    if (is_odd("crash"))
        abort();
    while (is_odd("hang"))
        pause();
    if (is_odd("no-memory"))
        return CL_MEM_OBJECT_ALLOCATION_FAILURE;
    return launch(queue, kernel, dimensions, offset, global_size, group_size, wait_count, waits, event);
}

cl_int clEnqueueReadBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset, size_t size,
                           void *data, cl_uint wait_count, const cl_event *waits, cl_event *event) {
    read_function *read;
    *(void **)&read = dlsym(library, "clEnqueueReadBuffer");
    const cl_int error = read(queue, buffer, blocking, offset, size, data, wait_count, waits, event);
    if (is_odd("wrong") && error == CL_SUCCESS && size == CHECKED_SIZE)
        *(float *)data = *(float *)data < 0.5f ? 1 : 0;
    return error;
}
