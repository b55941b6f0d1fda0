#include "opencl/programs.h"

#include <string.h>

#include "opencl/build_options.h"
#include "opencl/cl_error.h"
#include "opencl/opencl_device.h"
#include "opencl/prefetch.h"
#include "opencl/program.h"
#include "runtime/mapping.h"
#include "runtime/queue.h"

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
    gscl_flush(context); /* building takes long */
    GSCL_TRY(make_program(context, kind, text, found));
    gscl_program_keep(context, *found);
    return GSCL_OK;
}

/* Fails where the device cannot run the kernel in groups of the size that it requires (GROUP_OF in cl/macros.h), which may take
 * more registers or local memory than there are. */
static gscl_result check_group(gscl_context *context, const gscl_opencl_kernel *kernel) {
    const cl_device_id id = gscl_opencl(context)->id;
    size_t needed[3] = {0}, largest = 0;
    if (gscl_opencl(context)->quirks->understates_groups)
        return GSCL_OK;
    GSCL_CL(context, clGetKernelWorkGroupInfo, kernel->kernel, id, CL_KERNEL_COMPILE_WORK_GROUP_SIZE, sizeof needed,
            needed, NULL);
    GSCL_CL(context, clGetKernelWorkGroupInfo, kernel->kernel, id, CL_KERNEL_WORK_GROUP_SIZE, sizeof largest, &largest,
            NULL);
    if (needed[0] <= largest)
        return GSCL_OK;
    return gscl_fail(context, GSCL_ERROR_GROUP_SIZE,
                     "%s runs the kernel %s in work-groups of at most %zu work-items, and it needs %zu",
                     context->info.device_name, kernel->base.name, largest, needed[0]);
}

static gscl_result create_kernel(gscl_context *context, struct gscl_program *program, const char *name,
                                 gscl_opencl_kernel *kernel) {
    cl_int error;
    *kernel = (gscl_opencl_kernel){.base = {.name = name, .may_build = program->is_new}};
    kernel->kernel = gscl_cl.clCreateKernel(program->program, name, &error);
    if (error != CL_SUCCESS)
        return gscl_cl_fail(context, error, "clCreateKernel", "");
    const gscl_result result = check_group(context, kernel);
    if (result != GSCL_OK)
        gscl_cl.clReleaseKernel(kernel->kernel);
    return result;
}

static gscl_result find_kernel(gscl_context *context, gscl_program_kind kind, const gscl_kernel_options *options,
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

/* Programs that visit splats are built for smaller groups where the device cannot run those that they have. */
gscl_result gscl_opencl_kernel_find(gscl_context *context, gscl_program_kind kind, const gscl_kernel_options *options,
                                    const char *name, gscl_kernel **kernel) {
    const bool visits_splats = kind == GSCL_PROGRAM_SCALAR_RDO || kind == GSCL_PROGRAM_CODEBOOK;
    gscl_result result = find_kernel(context, kind, options, name, kernel);
    while (result == GSCL_ERROR_GROUP_SIZE && visits_splats && gscl_rdo_group_halve(context))
        result = find_kernel(context, kind, options, name, kernel);
    return result;
}

void gscl_programs_free(gscl_context *context) {
    gscl_opencl_prefetch_end(context);
    while (gscl_opencl(context)->programs) {
        struct gscl_program *next = gscl_opencl(context)->programs->next;
        gscl_program_free(gscl_opencl(context)->programs);
        gscl_opencl(context)->programs = next;
    }
}
