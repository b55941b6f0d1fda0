/* Loaded into the tool (LD_PRELOAD), it stands for an OpenCL implementation that builds the first program for longer than
 * the tool stays silent. */
#define _GNU_SOURCE
#include <CL/cl.h>
#include <dlfcn.h>
#include <unistd.h>

typedef cl_int build_function(cl_program, cl_uint, const cl_device_id *, const char *,
                              void(CL_CALLBACK *)(cl_program, void *), void *);

cl_int clBuildProgram(cl_program program, cl_uint count, const cl_device_id *devices, const char *options,
                      void(CL_CALLBACK *notify)(cl_program, void *), void *data) {
    static int was_slow;
    build_function *build;
    *(void **)&build = dlsym(RTLD_NEXT, "clBuildProgram");
    if (!was_slow++)
        usleep(1200000);
    return build(program, count, devices, options, notify, data);
}
