/* What the parts of opencl_probe share: the device, and what ends the program. */
#ifndef GSCL_TESTS_OPENCL_PROBE_H
#define GSCL_TESTS_OPENCL_PROBE_H

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

/* The first device, with a context and a queue in order. */
typedef struct opencl_probe {
    cl_device_id device;
    cl_context context;
    cl_command_queue queue;
} opencl_probe;

/* Ends the program where a call fails. */
void probe_check(cl_int error, const char *call);

#define CHECK(call) probe_check((call), #call)

double probe_seconds(void);

/* Prints what launches, waits and copies take. */
void probe_latency(const opencl_probe *probe);

/* Builds NAME.cl with the options in NAME.options for each NAME, and prints what the implementation tells of its
 * kernels.  Returns the number of programs that do not build. */
int probe_builds(const opencl_probe *probe, const char *folder, char *const *names, int count);

#endif
