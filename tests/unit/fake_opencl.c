#include "fake_opencl.h"

#include <string.h>

#include "opencl/library.h"

fake_opencl fake;

/* The handle of the second device, which never reaches the real implementation. */
static char second_device;
#define SECOND_DEVICE ((cl_device_id)(void *)&second_device)
static cl_device_id first_device;

/* The functions of the library. */
static gscl_cl_functions real;

/* Copies a value as clGet*Info does; it fails when the buffer is too small. */
static cl_int copy_info(const void *from, size_t length, size_t size, void *to, size_t *needed) {
    if (needed)
        *needed = length;
    if (to && size < length)
        return CL_INVALID_VALUE;
    if (to)
        memcpy(to, from, length);
    return CL_SUCCESS;
}

static cl_int CL_API_CALL fake_get_device_ids(cl_platform_id platform, cl_device_type type, cl_uint capacity,
                                              cl_device_id *devices, cl_uint *count) {
    cl_uint number = 0;
    cl_device_id all[64];
    const cl_int error = real.clGetDeviceIDs(platform, type, 64, all, &number);
    if (error != CL_SUCCESS)
        return error;
    first_device = all[0];
    if (fake.second_device)
        all[number++] = SECOND_DEVICE;
    if (count)
        *count = number;
    if (devices)
        memcpy(devices, all, (capacity < number ? capacity : number) * sizeof *devices);
    return CL_SUCCESS;
}

/* Copies one of the numbers; CL_INVALID_DEVICE for other parameters. */
static cl_int copy_number(const fake_numbers *numbers, cl_device_info parameter, size_t size, void *to,
                          size_t *needed) {
    switch (parameter) {
    case CL_DEVICE_HOST_UNIFIED_MEMORY:
        return copy_info(&numbers->shares_memory, sizeof numbers->shares_memory, size, to, needed);
    case CL_DEVICE_GLOBAL_MEM_SIZE:
        return copy_info(&numbers->memory, sizeof numbers->memory, size, to, needed);
    case CL_DEVICE_MAX_COMPUTE_UNITS:
        return copy_info(&numbers->units, sizeof numbers->units, size, to, needed);
    default:
        return CL_INVALID_DEVICE;
    }
}

static cl_int CL_API_CALL fake_get_device_info(cl_device_id device, cl_device_info parameter, size_t size, void *value,
                                               size_t *needed) {
    const bool unavailable = device == SECOND_DEVICE ? fake.second_unavailable : fake.first_unavailable;
    const fake_numbers *numbers = device == SECOND_DEVICE ? &fake.second : &fake.first;
    const cl_bool no = CL_FALSE;
    if (fake.failing_info && parameter == fake.failing_info)
        return CL_OUT_OF_RESOURCES;
    if (numbers->is_read && copy_number(numbers, parameter, size, value, needed) == CL_SUCCESS)
        return CL_SUCCESS;
    if (parameter == CL_DEVICE_AVAILABLE && unavailable)
        return copy_info(&no, sizeof no, size, value, needed);
    if (parameter == CL_DEVICE_TYPE && fake.device_type)
        return copy_info(&fake.device_type, sizeof fake.device_type, size, value, needed);
    if (parameter == CL_DEVICE_MAX_WORK_GROUP_SIZE && fake.largest_group)
        return copy_info(&fake.largest_group, sizeof fake.largest_group, size, value, needed);
    if (parameter == CL_DEVICE_NAME && fake.device_name)
        return copy_info(fake.device_name, strlen(fake.device_name) + 1, size, value, needed);
    return real.clGetDeviceInfo(device == SECOND_DEVICE ? first_device : device, parameter, size, value, needed);
}

static cl_int CL_API_CALL fake_get_platform_info(cl_platform_id platform, cl_platform_info parameter, size_t size,
                                                 void *value, size_t *needed) {
    if (parameter == CL_PLATFORM_NAME && fake.platform_name)
        return copy_info(fake.platform_name, strlen(fake.platform_name) + 1, size, value, needed);
    return real.clGetPlatformInfo(platform, parameter, size, value, needed);
}

static cl_context CL_API_CALL fake_create_context(const cl_context_properties *properties, cl_uint count,
                                                  const cl_device_id *devices, fake_notice notice, void *data,
                                                  cl_int *error) {
    fake.notice = notice;
    fake.notice_data = data;
    fake.contexts++;
    return real.clCreateContext(properties, count, devices, notice, data, error);
}

static cl_int CL_API_CALL fake_build(cl_program program, cl_uint count, const cl_device_id *devices,
                                     const char *options, void(CL_CALLBACK *built)(cl_program, void *), void *data) {
    fake.builds++;
    return real.clBuildProgram(program, count, devices, options, built, data);
}

static cl_int CL_API_CALL fake_get_kernel_group_info(cl_kernel kernel, cl_device_id device,
                                                     cl_kernel_work_group_info parameter, size_t size, void *value,
                                                     size_t *needed) {
    if (parameter == CL_KERNEL_WORK_GROUP_SIZE && fake.largest_kernel_group)
        return copy_info(&fake.largest_kernel_group, sizeof fake.largest_kernel_group, size, value, needed);
    return real.clGetKernelWorkGroupInfo(kernel, device, parameter, size, value, needed);
}

static cl_int CL_API_CALL fake_launch(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions,
                                      const size_t *offset, const size_t *global_size, const size_t *group_size,
                                      cl_uint wait_count, const cl_event *waits, cl_event *event) {
    if (fake.launch_error != CL_SUCCESS)
        return fake.launch_error;
    return real.clEnqueueNDRangeKernel(queue, kernel, dimensions, offset, global_size, group_size, wait_count, waits,
                                       event);
}

static void *CL_API_CALL fake_map(cl_command_queue queue, cl_mem buffer, cl_bool blocking, cl_map_flags flags,
                                  size_t offset, size_t size, cl_uint wait_count, const cl_event *waits,
                                  cl_event *event, cl_int *error) {
    fake.maps++;
    if (fake.map_error == CL_SUCCESS)
        return real.clEnqueueMapBuffer(queue, buffer, blocking, flags, offset, size, wait_count, waits, event, error);
    *error = fake.map_error;
    return NULL;
}

static cl_int CL_API_CALL fake_flush(cl_command_queue queue) {
    fake.flushes++;
    return real.clFlush(queue);
}

void fake_opencl_install(void) {
    if (gscl_opencl_library())
        return; /* there are no devices */
    real = gscl_cl;
    gscl_cl.clGetDeviceIDs = fake_get_device_ids;
    gscl_cl.clGetDeviceInfo = fake_get_device_info;
    gscl_cl.clGetPlatformInfo = fake_get_platform_info;
    gscl_cl.clCreateContext = fake_create_context;
    gscl_cl.clBuildProgram = fake_build;
    gscl_cl.clGetKernelWorkGroupInfo = fake_get_kernel_group_info;
    gscl_cl.clEnqueueNDRangeKernel = fake_launch;
    gscl_cl.clEnqueueMapBuffer = fake_map;
    gscl_cl.clFlush = fake_flush;
}
