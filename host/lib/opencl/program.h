/* One program: its sources, and building it. */
#ifndef GSCL_LIB_PROGRAM_H
#define GSCL_LIB_PROGRAM_H

#include <CL/cl.h>

#include "opencl/build_options.h"
#include "runtime/backend.h"

#define GSCL_MAX_KERNELS 24 /* of a program */

typedef struct gscl_opencl_kernel {
    gscl_kernel base;
    cl_kernel kernel;
} gscl_opencl_kernel;

struct gscl_program {
    struct gscl_program *next;
    gscl_program_kind kind;
    char options[GSCL_MAX_BUILD_OPTIONS];
    cl_program program; /* NULL: not built yet */
    bool is_new;        /* it was built from its sources rather than found built */
    size_t kernel_count;
    gscl_opencl_kernel kernels[GSCL_MAX_KERNELS];
};

/* Creates a program of a kind with these options of gscl_build_options, to be built. */
gscl_result gscl_program_create(gscl_context *context, gscl_program_kind kind, const char *options,
                                struct gscl_program **program);
void gscl_program_free(struct gscl_program *program);
/* Makes a program again one that is to be built. */
void gscl_program_drop(struct gscl_program *program);

/* The program of a kind with these options that the context keeps; NULL where it keeps none. */
struct gscl_program *gscl_program_find(const gscl_context *context, gscl_program_kind kind, const char *options);
/* Gives a built program to the context. */
void gscl_program_keep(gscl_context *context, struct gscl_program *program);

/* Takes the program from another context of the device (shared_device.h) or from the cache (program_cache.h), or builds it and
 * tells the caller of it. */
gscl_result gscl_program_make(gscl_context *context, struct gscl_program *program);

#endif
