#include "runtime/programs.h"

#include <string.h>

#include "runtime/build_options.h"
#include "runtime/opencl.h"
#include "runtime/prefetch.h"
#include "runtime/program.h"

/* Takes the program that another thread has built, or makes it. */
static gscl_result make_program(gscl_context *context, gscl_program_kind kind, const char *options,
                                struct gscl_program **made) {
    *made = gscl_prefetch_take(context, kind, options);
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

gscl_result gscl_kernel(gscl_context *context, gscl_program_kind kind, const gscl_kernel_options *options,
                        const char *name, cl_kernel *kernel) {
    struct gscl_program *program;
    GSCL_TRY(get_program(context, kind, options, &program));
    for (size_t i = 0; i < program->kernel_count; i++)
        if (strcmp(program->kernels[i].name, name) == 0) {
            *kernel = program->kernels[i].kernel;
            return GSCL_OK;
        }
    if (program->kernel_count == GSCL_MAX_KERNELS)
        return gscl_fail(context, GSCL_ERROR_KERNEL_BUILD, "a program has more than %d kernels", GSCL_MAX_KERNELS);
    cl_int error;
    *kernel = clCreateKernel(program->program, name, &error);
    if (error != CL_SUCCESS)
        return gscl_cl_fail(context, error, "clCreateKernel");
    if (program->is_new && context->unlaunched_count < GSCL_MAX_UNLAUNCHED)
        context->unlaunched[context->unlaunched_count++] = *kernel;
    program->kernels[program->kernel_count].name = name;
    program->kernels[program->kernel_count++].kernel = *kernel;
    return GSCL_OK;
}

void gscl_programs_free(gscl_context *context) {
    gscl_prefetch_end(context);
    while (context->programs) {
        struct gscl_program *next = context->programs->next;
        gscl_program_free(context->programs);
        context->programs = next;
    }
}
