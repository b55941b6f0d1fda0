#include "opencl/programs.h"

#include <string.h>

#include "opencl/build_options.h"
#include "opencl/cl_error.h"
#include "opencl/opencl_device.h"
#include "opencl/prefetch.h"
#include "opencl/program.h"

/* Takes the program that another thread has built, or makes it. */
static gscl_result make_program(gscl_context *context, gscl_program_kind kind, const char *options,
                                struct gscl_program **made) {
    *made = gscl_opencl_prefetch_take(context, kind, options);
    if (*made)
        return GSCL_OK;
    GSCL_TRY(gscl_program_create(context, kind, options, made));
    const gscl_result result = gscl_program_make(context, *made);
    if (result != GSCL_OK)
        gscl_program_free(*made);
    return result;
}

static gscl_result get_program(gscl_context *context, gscl_program_kind kind, const gscl_kernel_options *options,
                               struct gscl_program **found) {
    char text[GSCL_MAX_BUILD_OPTIONS];
    GSCL_TRY(gscl_build_options(context, kind, options, text));
    *found = gscl_program_find(context, kind, text);
    if (*found)
        return GSCL_OK;
    GSCL_TRY(make_program(context, kind, text, found));
    gscl_program_keep(context, *found);
    return GSCL_OK;
}

static gscl_result create_kernel(gscl_context *context, struct gscl_program *program, const char *name,
                                 gscl_opencl_kernel *kernel) {
    cl_int error;
    *kernel = (gscl_opencl_kernel){.base = {.name = name, .may_build = program->is_new}};
    kernel->kernel = gscl_cl.clCreateKernel(program->program, name, &error);
    return error == CL_SUCCESS ? GSCL_OK : gscl_cl_fail(context, error, "clCreateKernel", "");
}

gscl_result gscl_opencl_kernel_find(gscl_context *context, gscl_program_kind kind, const gscl_kernel_options *options,
                                    const char *name, gscl_kernel **kernel) {
    struct gscl_program *program;
    GSCL_TRY(get_program(context, kind, options, &program));
    for (size_t i = 0; i < program->kernel_count; i++)
        if (strcmp(program->kernels[i].base.name, name) == 0) {
            *kernel = &program->kernels[i].base;
            return GSCL_OK;
        }
    if (program->kernel_count == GSCL_MAX_KERNELS)
        return gscl_fail(context, GSCL_ERROR_KERNEL_BUILD, "a program has more than %d kernels", GSCL_MAX_KERNELS);
    gscl_opencl_kernel *created = &program->kernels[program->kernel_count];
    GSCL_TRY(create_kernel(context, program, name, created));
    program->kernel_count++;
    *kernel = &created->base;
    return GSCL_OK;
}

void gscl_programs_free(gscl_context *context) {
    gscl_opencl_prefetch_end(context);
    while (gscl_opencl(context)->programs) {
        struct gscl_program *next = gscl_opencl(context)->programs->next;
        gscl_program_free(gscl_opencl(context)->programs);
        gscl_opencl(context)->programs = next;
    }
}
