/* What launches, waits and copies take: medians. */
#include "opencl_probe.h"

#include <stdio.h>
#include <stdlib.h>

#define RUNS 15
#define LAUNCHES 1000
#define MAX_BYTES (72u << 20) /* the samples of 25 megapixels of RGB */

static int compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values) {
    qsort(values, RUNS, sizeof *values, compare);
    return values[RUNS / 2];
}

static const char source[] = "__kernel void add(__global float *a) { if (get_global_id(0) == 0) a[0] += 1.0f; }";

/* A kernel of one work-group that each launch of it has to wait for. */
static cl_kernel make_kernel(const opencl_probe *probe, cl_mem buffer) {
    const char *text = source;
    cl_int error;
    const double begin = probe_seconds();
    cl_program program = clCreateProgramWithSource(probe->context, 1, &text, NULL, &error);
    CHECK(error);
    CHECK(clBuildProgram(program, 1, &probe->device, "-cl-std=CL1.2", NULL, NULL));
    printf("a program of one line is built in %.1f ms\n", 1e3 * (probe_seconds() - begin));
    cl_kernel kernel = clCreateKernel(program, "add", &error);
    CHECK(error);
    CHECK(clSetKernelArg(kernel, 0, sizeof buffer, &buffer));
    return kernel;
}

static void launch(const opencl_probe *probe, cl_kernel kernel) {
    const size_t items = 64;
    CHECK(clEnqueueNDRangeKernel(probe->queue, kernel, 1, NULL, &items, &items, 0, NULL, NULL));
}

static void measure_launches(const opencl_probe *probe, cl_kernel kernel) {
    double whole[RUNS], enqueued[RUNS], alone[RUNS];
    for (int run = 0; run < RUNS; run++) {
        double begin = probe_seconds();
        for (int i = 0; i < LAUNCHES; i++)
            launch(probe, kernel);
        enqueued[run] = probe_seconds() - begin;
        CHECK(clFinish(probe->queue));
        whole[run] = probe_seconds() - begin;
        begin = probe_seconds();
        launch(probe, kernel);
        CHECK(clFinish(probe->queue));
        alone[run] = probe_seconds() - begin;
    }
    printf("%d dependent launches: %.2f us each, of which the host takes %.2f us to enqueue it\n", LAUNCHES,
           1e6 / LAUNCHES * median(whole), 1e6 / LAUNCHES * median(enqueued));
    printf("a launch and clFinish: %.1f us\n", 1e6 * median(alone));
}

/* Reads and writes between the device and memory of the host, where `kind` names it. */
static void measure_copies(const opencl_probe *probe, cl_mem buffer, void *memory, const char *kind) {
    const size_t sizes[] = {4, 4096, 1179648, MAX_BYTES};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        double reads[RUNS], writes[RUNS];
        for (int run = 0; run < RUNS; run++) {
            double begin = probe_seconds();
            CHECK(clEnqueueReadBuffer(probe->queue, buffer, CL_TRUE, 0, sizes[i], memory, 0, NULL, NULL));
            reads[run] = probe_seconds() - begin;
            begin = probe_seconds();
            CHECK(clEnqueueWriteBuffer(probe->queue, buffer, CL_TRUE, 0, sizes[i], memory, 0, NULL, NULL));
            writes[run] = probe_seconds() - begin;
        }
        printf("%u bytes of %s memory: read in %.1f us, written in %.1f us\n", (unsigned)sizes[i], kind,
               1e6 * median(reads), 1e6 * median(writes));
    }
}

static cl_mem make_buffer(const opencl_probe *probe, cl_mem_flags flags) {
    cl_int error;
    cl_mem buffer = clCreateBuffer(probe->context, flags, MAX_BYTES, NULL, &error);
    CHECK(error);
    return buffer;
}

void probe_latency(const opencl_probe *probe) {
    cl_int error;
    cl_mem buffer = make_buffer(probe, CL_MEM_READ_WRITE), pinned = make_buffer(probe, CL_MEM_ALLOC_HOST_PTR);
    void *pageable = calloc(1, MAX_BYTES);
    if (!pageable)
        probe_check(CL_OUT_OF_HOST_MEMORY, "calloc");
    measure_launches(probe, make_kernel(probe, buffer));
    measure_copies(probe, buffer, pageable, "pageable");
    void *mapped = clEnqueueMapBuffer(probe->queue, pinned, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, MAX_BYTES, 0, NULL,
                                      NULL, &error);
    CHECK(error);
    measure_copies(probe, buffer, mapped, "pinned");
    free(pageable);
}
