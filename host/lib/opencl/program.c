#include "opencl/program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "host/system/clock.h"
#include "opencl/cl_error.h"
#include "opencl/kernel_sources.h"
#include "opencl/opencl_device.h"
#include "opencl/program_cache.h"
#include "opencl/shared_device.h"
#include "opencl/tunables.h"
#include "runtime/stage_clock.h"

/* Keeps the compiler's own header of built-in functions out and lets cl/builtins.h take its place. */
#define OWN_BUILTINS " -D_OPENCL_H_ -DGSCL_BUILTINS"

static const struct gscl_kernel_source *find_source(const char *name) {
    for (size_t i = 0; i < gscl_kernel_source_count; i++)
        if (strcmp(gscl_kernel_sources[i].name, name) == 0)
            return &gscl_kernel_sources[i];
    return NULL;
}

/* The source files of a program. */
typedef struct program_sources {
    size_t count;
    const char *texts[GSCL_MAX_PROGRAM_FILES];
    size_t lengths[GSCL_MAX_PROGRAM_FILES];
} program_sources;

/* Returns NULL, or the name of the file that is missing in this build. */
static const char *find_sources(gscl_program_kind kind, program_sources *sources) {
    const char *const *names = gscl_program_files[kind];
    for (sources->count = 0; names[sources->count]; sources->count++) {
        const struct gscl_kernel_source *source = find_source(names[sources->count]);
        if (!source)
            return names[sources->count];
        sources->texts[sources->count] = source->text;
        sources->lengths[sources->count] = source->length;
    }
    return NULL;
}

/* The compiler's log, to be freed; NULL when it cannot be read. */
static char *build_log(const gscl_context *context, const struct gscl_program *program) {
    size_t size = 0;
    if (gscl_cl.clGetProgramBuildInfo(program->program, gscl_opencl(context)->id, CL_PROGRAM_BUILD_LOG, 0, NULL,
                                      &size) != CL_SUCCESS)
        return NULL;
    char *log = calloc(size + 1, 1);
    if (log && gscl_cl.clGetProgramBuildInfo(program->program, gscl_opencl(context)->id, CL_PROGRAM_BUILD_LOG, size,
                                             log, NULL) != CL_SUCCESS) {
        free(log);
        log = NULL;
    }
    return log;
}

/* Logs the compiler's messages; the first line becomes the message of the error. */
static gscl_result build_fail(gscl_context *context, const struct gscl_program *program, cl_int error) {
    char *log = build_log(context, program);
    gscl_log(context, GSCL_LOG_ERROR, "kernel build with %s: %s", program->options, log ? log : "");
    const gscl_result result =
        gscl_fail(context, GSCL_ERROR_KERNEL_BUILD, "%s could not build the kernels (%s) with %s: %.*s",
                  context->info.device_name, gscl_cl_error_name(error), program->options,
                  log ? (int)strcspn(log, "\n") : 0, log ? log : "");
    free(log);
    return result;
}

/* Creates and builds the program, in place of one that was created before.  `extra`: options beyond its own. */
static gscl_result try_build(gscl_context *context, struct gscl_program *program, program_sources *sources,
                             const char *extra, cl_int *error) {
    char options[GSCL_MAX_BUILD_OPTIONS + sizeof OWN_BUILTINS];
    snprintf(options, sizeof options, "%s%s", program->options, extra); /* always fits */
    if (program->program)
        gscl_cl.clReleaseProgram(program->program);
    program->program = gscl_cl.clCreateProgramWithSource(gscl_opencl(context)->context, (cl_uint)sources->count,
                                                         sources->texts, sources->lengths, error);
    if (*error != CL_SUCCESS)
        return gscl_cl_fail(context, *error, "clCreateProgramWithSource", "");
    *error = gscl_cl.clBuildProgram(program->program, 1, &gscl_opencl(context)->id, options, NULL, NULL);
    return GSCL_OK;
}

/* Builds with cl/builtins.h where it is of use; that file has no double precision. */
static gscl_result build(gscl_context *context, struct gscl_program *program, program_sources *sources) {
    cl_int error = CL_BUILD_PROGRAM_FAILURE;
    if (gscl_opencl(context)->own_builtins && program->kind != GSCL_PROGRAM_ACCURACY) {
        GSCL_TRY(try_build(context, program, sources, OWN_BUILTINS, &error));
        gscl_opencl(context)->own_builtins = error == CL_SUCCESS;
        if (error != CL_SUCCESS)
            gscl_log(context, GSCL_LOG_DEBUG, "cl/builtins.h is not enough for %s", program->options);
    }
    if (error != CL_SUCCESS)
        GSCL_TRY(try_build(context, program, sources, "", &error));
    return error == CL_SUCCESS ? GSCL_OK : build_fail(context, program, error);
}

/* Builds the program, and tells the caller of it. */
static gscl_result build_reported(gscl_context *context, struct gscl_program *program, program_sources *sources) {
    gscl_report_build(context, true);
    const gscl_result result = build(context, program, sources);
    gscl_report_build(context, false);
    return result;
}

gscl_result gscl_program_create(gscl_context *context, gscl_program_kind kind, const char *options,
                                struct gscl_program **program) {
    struct gscl_program *p = *program = calloc(1, sizeof *p);
    if (!p)
        return gscl_fail_memory(context);
    p->kind = kind;
    snprintf(p->options, sizeof p->options, "%s", options);
    return GSCL_OK;
}

void gscl_program_drop(struct gscl_program *program) {
    for (size_t i = 0; i < program->kernel_count; i++)
        gscl_cl.clReleaseKernel(program->kernels[i].kernel);
    program->kernel_count = 0;
    if (program->program)
        gscl_cl.clReleaseProgram(program->program);
    program->program = NULL;
}

void gscl_program_free(struct gscl_program *program) {
    gscl_program_drop(program);
    free(program);
}

struct gscl_program *gscl_program_find(const gscl_context *context, gscl_program_kind kind, const char *options) {
    struct gscl_program *p = gscl_opencl(context)->programs;
    while (p && !(p->kind == kind && strcmp(p->options, options) == 0))
        p = p->next;
    return p;
}

void gscl_program_keep(gscl_context *context, struct gscl_program *program) {
    program->next = gscl_opencl(context)->programs;
    gscl_opencl(context)->programs = program;
}

/* Takes the program from the cache, or builds it. */
static gscl_result make_new(gscl_context *context, struct gscl_program *program) {
    const double start = gscl_now();
    program_sources sources;
    char key[GSCL_PROGRAM_KEY_SIZE];
    const char *missing = find_sources(program->kind, &sources);
    if (missing)
        return gscl_fail(context, GSCL_ERROR_KERNEL_BUILD, "kernel source %s is not in this build", missing);
    const bool has_key =
        gscl_program_key(context, program->options, sources.texts, sources.lengths, sources.count, key);
    program->program = has_key ? gscl_program_load(context, key, program->options) : NULL;
    const bool found = program->program != NULL;
    const gscl_result result = found ? GSCL_OK : build_reported(context, program, &sources);
    program->is_new = !found && gscl_now() - start > gscl_opencl_tunables.found_build_s;
    if (result == GSCL_OK && has_key && !found)
        gscl_program_save(context, key, program->program);
    gscl_log(context, GSCL_LOG_DEBUG, "%s a program in %.0f ms: %s", found ? "loaded" : "built",
             1e3 * (gscl_now() - start), program->options);
    return result;
}

gscl_result gscl_program_make(gscl_context *context, struct gscl_program *program) {
    program->program = gscl_shared_program_take(context, program->kind, program->options);
    if (program->program)
        return GSCL_OK;
    const gscl_result result = make_new(context, program);
    gscl_shared_program_give(context, program->kind, program->options, result == GSCL_OK ? program->program : NULL);
    return result;
}
