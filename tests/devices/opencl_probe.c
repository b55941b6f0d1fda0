/* What an OpenCL implementation says of its first device, what its calls take, and what it makes of programs:
 *
 *     opencl_probe info
 *     opencl_probe latency
 *     opencl_probe build FOLDER NAME...
 *
 * FOLDER has NAME.cl and NAME.options for each NAME. */
#define _POSIX_C_SOURCE 200112L
#include "opencl_probe.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

void probe_check(cl_int error, const char *call) {
    if (error == CL_SUCCESS)
        return;
    printf("%s fails with %d\n", call, (int)error);
    exit(1);
}

double probe_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void print_text(cl_device_id device, const char *name, cl_device_info what) {
    static char text[1 << 16];
    text[0] = '\0';
    clGetDeviceInfo(device, what, sizeof text, text, NULL);
    printf("%-24s %s\n", name, text);
}

static void print_number(cl_device_id device, const char *name, cl_device_info what) {
    uint64_t value = 0; /* little-endian where the property has 4 bytes */
    if (clGetDeviceInfo(device, what, sizeof value, &value, NULL) == CL_SUCCESS)
        printf("%-24s %llu\n", name, (unsigned long long)value);
}

static void print_info(cl_device_id device) {
    static const struct {
        const char *name;
        cl_device_info what;
        void (*print)(cl_device_id device, const char *name, cl_device_info what);
    } properties[] = {{"device", CL_DEVICE_NAME, print_text},
                      {"version", CL_DEVICE_VERSION, print_text},
                      {"driver", CL_DRIVER_VERSION, print_text},
                      {"extensions", CL_DEVICE_EXTENSIONS, print_text},
                      {"compute units", CL_DEVICE_MAX_COMPUTE_UNITS, print_number},
                      {"clock, MHz", CL_DEVICE_MAX_CLOCK_FREQUENCY, print_number},
                      {"largest work-group", CL_DEVICE_MAX_WORK_GROUP_SIZE, print_number},
                      {"local memory, bytes", CL_DEVICE_LOCAL_MEM_SIZE, print_number},
                      {"global memory, bytes", CL_DEVICE_GLOBAL_MEM_SIZE, print_number},
                      {"largest buffer, bytes", CL_DEVICE_MAX_MEM_ALLOC_SIZE, print_number},
                      {"memory of the host", CL_DEVICE_HOST_UNIFIED_MEMORY, print_number},
                      {"timer, ns", CL_DEVICE_PROFILING_TIMER_RESOLUTION, print_number}};
    for (size_t i = 0; i < sizeof properties / sizeof *properties; i++)
        properties[i].print(device, properties[i].name, properties[i].what);
}

static opencl_probe open_device(void) {
    opencl_probe probe;
    cl_platform_id platform;
    cl_int error;
    CHECK(clGetPlatformIDs(1, &platform, NULL));
    CHECK(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &probe.device, NULL));
    probe.context = clCreateContext(NULL, 1, &probe.device, NULL, NULL, &error);
    CHECK(error);
    probe.queue = clCreateCommandQueue(probe.context, probe.device, 0, &error);
    CHECK(error);
    return probe;
}

int main(int count, char **arguments) {
    const char *what = count > 1 ? arguments[1] : "";
    setvbuf(stdout, NULL, _IOLBF, 0); /* what hangs loses only its own line */
    if (strcmp(what, "info") == 0 && count == 2) {
        print_info(open_device().device);
        return 0;
    }
    const opencl_probe probe = open_device();
    if (strcmp(what, "latency") == 0 && count == 2) {
        probe_latency(&probe);
        return 0;
    }
    if (strcmp(what, "build") == 0 && count > 3)
        return probe_builds(&probe, arguments[2], arguments + 3, count - 3) > 0;
    fprintf(stderr, "usage: opencl_probe info | latency | build FOLDER NAME...\n");
    return 2;
}
