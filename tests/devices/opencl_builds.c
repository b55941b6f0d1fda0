/* What an OpenCL implementation makes of programs: the time, its messages, and what it tells of the kernels. */
#include "opencl_probe.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_SOURCE (1 << 20)
#define MAX_OPTIONS 4096
#define MAX_KERNELS 64

static char source[MAX_SOURCE], options[MAX_OPTIONS], text[MAX_SOURCE];

static void read_file(const char *folder, const char *name, const char *suffix, char *content, size_t capacity) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s%s", folder, name, suffix);
    FILE *file = fopen(path, "r");
    if (!file) {
        printf("%s cannot be opened\n", path);
        exit(1);
    }
    content[fread(content, 1, capacity - 1, file)] = '\0';
    fclose(file);
}

/* NVIDIA's compiler tells registers and spills where it is asked to. */
static void add_verbose_option(cl_device_id device) {
    static const char verbose[] = " -cl-nv-verbose";
    clGetDeviceInfo(device, CL_DEVICE_EXTENSIONS, sizeof text - 1, text, NULL);
    if (strstr(text, "cl_nv_compiler_options") && strlen(options) + sizeof verbose <= sizeof options)
        strcat(options, verbose);
}

static void print_kernel(cl_device_id device, cl_kernel kernel) {
    char name[128] = "";
    size_t items = 0, multiple = 0;
    cl_ulong local = 0, private = 0;
    clGetKernelInfo(kernel, CL_KERNEL_FUNCTION_NAME, sizeof name, name, NULL);
    clGetKernelWorkGroupInfo(kernel, device, CL_KERNEL_WORK_GROUP_SIZE, sizeof items, &items, NULL);
    clGetKernelWorkGroupInfo(kernel, device, CL_KERNEL_PREFERRED_WORK_GROUP_SIZE_MULTIPLE, sizeof multiple, &multiple,
                             NULL);
    clGetKernelWorkGroupInfo(kernel, device, CL_KERNEL_LOCAL_MEM_SIZE, sizeof local, &local, NULL);
    clGetKernelWorkGroupInfo(kernel, device, CL_KERNEL_PRIVATE_MEM_SIZE, sizeof private, &private, NULL);
    printf("    %-24s work-group at most %zu, multiple of %zu, %llu bytes of local and %llu of private memory\n", name,
           items, multiple, (unsigned long long)local, (unsigned long long)private);
}

static void print_kernels(cl_device_id device, cl_program program) {
    cl_kernel kernels[MAX_KERNELS];
    cl_uint count = 0;
    CHECK(clCreateKernelsInProgram(program, MAX_KERNELS, kernels, &count));
    for (cl_uint i = 0; i < count; i++) {
        print_kernel(device, kernels[i]);
        clReleaseKernel(kernels[i]);
    }
}

/* Whether a program builds. */
static int build(const opencl_probe *probe, const char *name) {
    const char *sources = source;
    cl_int error;
    cl_program program = clCreateProgramWithSource(probe->context, 1, &sources, NULL, &error);
    CHECK(error);
    const double begin = probe_seconds();
    error = clBuildProgram(program, 1, &probe->device, options, NULL, NULL);
    printf("%s: %s in %.0f ms\n", name, error == CL_SUCCESS ? "built" : "NOT BUILT", 1e3 * (probe_seconds() - begin));
    text[0] = '\0';
    clGetProgramBuildInfo(program, probe->device, CL_PROGRAM_BUILD_LOG, sizeof text - 1, text, NULL);
    for (const char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n"))
        printf("    %.300s\n", line);
    if (error == CL_SUCCESS)
        print_kernels(probe->device, program);
    clReleaseProgram(program);
    return error == CL_SUCCESS;
}

int probe_builds(const opencl_probe *probe, const char *folder, char *const *names, int count) {
    int failed = 0;
    const double begin = probe_seconds();
    for (int i = 0; i < count; i++) {
        read_file(folder, names[i], ".cl", source, sizeof source);
        read_file(folder, names[i], ".options", options, sizeof options);
        add_verbose_option(probe->device);
        failed += !build(probe, names[i]);
    }
    printf("= %d programs in %.1f s, %d not built\n", count, probe_seconds() - begin, failed);
    return failed;
}
