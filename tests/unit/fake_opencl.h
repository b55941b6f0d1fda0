/* Takes the place of functions of OpenCL that the library calls (opencl/library.h), and simulates devices that this machine
 * does not have.  All other calls reach the real implementation. */
#ifndef GSCL_TESTS_FAKE_OPENCL_H
#define GSCL_TESTS_FAKE_OPENCL_H

#include <CL/cl.h>
#include <stdbool.h>

typedef void(CL_CALLBACK *fake_notice)(const char *text, const void *details, size_t size, void *data);

/* What one device says of itself. */
typedef struct fake_numbers {
    bool is_read; /* else those of the real device are */
    cl_bool shares_memory;
    cl_ulong memory; /* bytes */
    cl_uint units;
} fake_numbers;

/* With all fields zero every call reaches the real implementation. */
typedef struct fake_opencl {
    const char *device_name, *platform_name; /* NULL: the real ones */
    cl_device_type device_type;              /* 0: the real one */
    bool second_device;                      /* each platform has one more device, a copy of its first */
    bool first_unavailable, second_unavailable;
    fake_numbers first, second;
    size_t largest_group;        /* of all devices, in work-items; 0: the real one */
    size_t largest_kernel_group; /* of all kernels, in work-items; 0: the real one */
    cl_device_info failing_info; /* clGetDeviceInfo fails for this parameter; 0: for none */
    cl_int launch_error;         /* result of clEnqueueNDRangeKernel instead of a launch; 0: it launches */
    cl_int map_error;            /* result of clEnqueueMapBuffer instead of an address; 0: it maps */
    fake_notice notice;          /* argument of the last clCreateContext */
    void *notice_data;
    int contexts, builds; /* calls of clCreateContext and clBuildProgram */
    int maps, flushes;    /* of clEnqueueMapBuffer and clFlush */
} fake_opencl;

extern fake_opencl fake;

/* To be called first. */
void fake_opencl_install(void);

#endif
