#include "runtime/programs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "runtime/kernel_sources.h"
#include "runtime/opencl.h"
#include "runtime/timing.h"

#define MAX_FILES 12
#define MAX_KERNELS 16
#define MAX_OPTIONS 384
#define SPARE_HEADER " -D_OPENCL_H_ -DGSCL_BUILTINS" /* cl/builtins.h */

struct gscl_program {
    struct gscl_program *next;
    gscl_program_kind kind;
    char options[MAX_OPTIONS];
    cl_program program;
    size_t kernel_count;
    struct {
        const char *name;
        cl_kernel kernel;
    } kernels[MAX_KERNELS];
};

/* Source files of each kind, in the order in which the compiler reads them. */
static const char *const program_files[GSCL_PROGRAM_KINDS][MAX_FILES] = {
    [GSCL_PROGRAM_RENDER] = {"builtins.h", "constants.h", "structs.h", "pixel.cl", "raster.cl", "splat_lanes.cl",
                             "project.cl", "bin.cl", "samples.cl"},
    [GSCL_PROGRAM_FIT] = {"builtins.h", "constants.h", "structs.h", "pixel.cl", "raster.cl", "splat_lanes.cl",
                          "project.cl", "bin.cl", "fit.cl", "update.cl"},
    [GSCL_PROGRAM_SCALAR_RDO] = {"builtins.h", "constants.h", "structs.h", "pixel.cl", "raster.cl", "splat_lanes.cl",
                                 "project.cl", "bin.cl", "outline.cl", "scalar_codes.cl", "texture.cl",
                                 "scalar_rdo.cl"},
    [GSCL_PROGRAM_CODEBOOK] = {"builtins.h", "constants.h", "structs.h", "pixel.cl", "raster.cl", "splat_lanes.cl",
                               "project.cl", "fit.cl", "update.cl", "outline.cl", "codebook.cl", "codebook_rdo.cl"},
    [GSCL_PROGRAM_SSIM] = {"builtins.h", "constants.h", "structs.h", "pixel.cl", "ssim.cl"},
    [GSCL_PROGRAM_IMAGE] = {"builtins.h", "constants.h", "structs.h", "image.cl"},
    [GSCL_PROGRAM_BENCHMARK] = {"builtins.h", "constants.h", "structs.h", "pixel.cl", "benchmark.cl"},
    [GSCL_PROGRAM_ACCURACY] = {"builtins.h", "constants.h", "structs.h", "pixel.cl", "raster.cl", "accuracy.cl"},
};

/* The two mappings of pixels to work-items (cl/pixel.cl). */
#define CPU_LANES 16
#define CPU_ROWS 16
#define CPU_CACHED_ROWS 512 /* 32 KB of a work-item's own memory */
#define GPU_LANES 4
#define GPU_ROWS 1

int gscl_mapping_lanes(const gscl_context *context) {
    return context->gpu_mapping ? GPU_LANES : CPU_LANES;
}
static int mapping_rows(const gscl_context *context) {
    return context->gpu_mapping ? GPU_ROWS : CPU_ROWS;
}

/* Only a fit has so many steps that the longer build pays. */
int gscl_splat_lanes(const gscl_context *context, gscl_program_kind kind) {
    return kind == GSCL_PROGRAM_FIT && !context->gpu_mapping ? GSCL_MAX_SPLAT_LANES : 1;
}

size_t gscl_tile_group_size(const gscl_context *context) {
    return (size_t)(GSCL_TILE / gscl_mapping_lanes(context)) * (size_t)(GSCL_TILE / mapping_rows(context));
}

size_t gscl_chunk_groups(const gscl_context *context, int width, int rows, size_t group_size) {
    int lanes = gscl_mapping_lanes(context);
    size_t chunks = (size_t)((width + lanes - 1) / lanes) * (size_t)rows;
    return (chunks + group_size - 1) / group_size;
}

/* What only accuracy.c asks for.  Constants of the double kernels are doubles. */
static void append_exactness(const gscl_kernel_options *options, char text[MAX_OPTIONS]) {
    size_t length = strlen(text);
    const char *suffix = options->is_double ? "" : "f";
    double support = options->support > 0 ? options->support : (double)GSCL_SUPPORT;
    if (options->support > 0 || options->is_double)
        length +=
            (size_t)snprintf(text + length, MAX_OPTIONS - length, " -DGSCL_SUPPORT=%.17e%s -DGSCL_WEIGHT_FLOOR=%.17e%s",
                             support, suffix, exp(-support), suffix);
    if (options->is_double)
        length += (size_t)snprintf(text + length, MAX_OPTIONS - length, " -DDOUBLE -DGSCL_MAX_ALPHA=0.999");
    if (options->exponential)
        length += (size_t)snprintf(text + length, MAX_OPTIONS - length, " -DEXPONENTIAL=%d", options->exponential);
    if (options->early_stop > 0)
        snprintf(text + length, MAX_OPTIONS - length, " -DEARLY_STOP=%.9ef", options->early_stop);
}

static void options_text(const gscl_context *context, gscl_program_kind kind, const gscl_kernel_options *options,
                         char text[MAX_OPTIONS]) {
    int length = snprintf(text, MAX_OPTIONS, "-cl-std=CL1.2");
    if (kind == GSCL_PROGRAM_IMAGE)
        return;
    bool fits = kind == GSCL_PROGRAM_FIT || kind == GSCL_PROGRAM_CODEBOOK;
    length += snprintf(text + length, MAX_OPTIONS - (size_t)length, " -DLANES=%d -DROWS=%d -DSPLAT_LANES=%d",
                       gscl_mapping_lanes(context), mapping_rows(context), gscl_splat_lanes(context, kind));
    length +=
        snprintf(text + length, MAX_OPTIONS - (size_t)length,
                 " -DBLEND=%d -DCOLOURS=%d -DALPHA_CHANNEL=%d -DOPACITY=%d -DTEXTURE=%d -DSHAPE=%d", options->blend,
                 options->colours, options->alpha_channel, options->opacity, options->texture, options->shape);
    if (fits || kind == GSCL_PROGRAM_SCALAR_RDO)
        length += snprintf(text + length, MAX_OPTIONS - (size_t)length, " -DWEIGHTED=%d", options->weighted);
    if (fits)
        snprintf(text + length, MAX_OPTIONS - (size_t)length, " -DLOSS=%d -DCACHED_ROWS=%d", options->loss,
                 context->gpu_mapping ? 0 : CPU_CACHED_ROWS);
    append_exactness(options, text);
}

static const struct gscl_kernel_source *find_source(const char *name) {
    for (size_t i = 0; i < gscl_kernel_source_count; i++)
        if (strcmp(gscl_kernel_sources[i].name, name) == 0)
            return &gscl_kernel_sources[i];
    return NULL;
}

/* Logs what the compiler said, and keeps the first line of it as the message. */
static gscl_result build_failed(gscl_context *context, struct gscl_program *program, cl_int error) {
    size_t size = 0;
    clGetProgramBuildInfo(program->program, context->device, CL_PROGRAM_BUILD_LOG, 0, NULL, &size);
    char *log = calloc(size + 1, 1);
    if (log)
        clGetProgramBuildInfo(program->program, context->device, CL_PROGRAM_BUILD_LOG, size, log, NULL);
    gscl_log(context, GSCL_LOG_ERROR, "kernel build with %s: %s", program->options, log ? log : "");
    gscl_result result =
        gscl_fail(context, GSCL_ERROR_KERNEL_BUILD, "%s could not build the kernels (%s) with %s: %.*s",
                  context->info.device_name, gscl_cl_error_name(error), program->options,
                  log ? (int)strcspn(log, "\n") : 0, log ? log : "");
    free(log);
    return result;
}

/* From the source files; takes the place of what was created before. */
static gscl_result program_create(gscl_context *context, struct gscl_program *program) {
    const char *texts[MAX_FILES];
    size_t lengths[MAX_FILES];
    cl_uint count = 0;
    for (; count < MAX_FILES && program_files[program->kind][count]; count++) {
        const struct gscl_kernel_source *source = find_source(program_files[program->kind][count]);
        if (!source)
            return gscl_fail(context, GSCL_ERROR_KERNEL_BUILD, "kernel source %s is not in this build",
                             program_files[program->kind][count]);
        texts[count] = source->text;
        lengths[count] = source->length;
    }
    cl_int error;
    if (program->program)
        clReleaseProgram(program->program);
    program->program = clCreateProgramWithSource(context->cl, count, texts, lengths, &error);
    return error == CL_SUCCESS ? GSCL_OK : gscl_cl_fail(context, error, "clCreateProgramWithSource");
}

/* Whether cl/builtins.h may stand for the compiler's header; it has no double precision. */
static bool can_spare_header(const gscl_context *context, gscl_program_kind kind) {
    char version[256] = "";
    clGetPlatformInfo(context->platform, CL_PLATFORM_VERSION, sizeof version, version, NULL);
    return !context->needs_header && kind != GSCL_PROGRAM_ACCURACY && strstr(version, "PoCL 3.");
}

static gscl_result program_build(gscl_context *context, struct gscl_program *program) {
    char options[MAX_OPTIONS + sizeof SPARE_HEADER];
    double start = gscl_now();
    cl_int error = CL_BUILD_PROGRAM_FAILURE;
    if (can_spare_header(context, program->kind)) {
        snprintf(options, sizeof options, "%s%s", program->options, SPARE_HEADER);
        GSCL_TRY(program_create(context, program));
        error = clBuildProgram(program->program, 1, &context->device, options, NULL, NULL);
        context->needs_header = error != CL_SUCCESS;
        if (context->needs_header)
            gscl_log(context, GSCL_LOG_DEBUG, "cl/builtins.h is not enough for %s", program->options);
    }
    if (error != CL_SUCCESS) {
        GSCL_TRY(program_create(context, program));
        error = clBuildProgram(program->program, 1, &context->device, program->options, NULL, NULL);
    }
    gscl_log(context, GSCL_LOG_DEBUG, "loaded a program in %.0f ms: %s", 1e3 * (gscl_now() - start), program->options);
    return error == CL_SUCCESS ? GSCL_OK : build_failed(context, program, error);
}

static void program_free(struct gscl_program *program) {
    for (size_t i = 0; i < program->kernel_count; i++)
        clReleaseKernel(program->kernels[i].kernel);
    if (program->program)
        clReleaseProgram(program->program);
    free(program);
}

static gscl_result program_get(gscl_context *context, gscl_program_kind kind, const gscl_kernel_options *options,
                               struct gscl_program **found) {
    char text[MAX_OPTIONS];
    options_text(context, kind, options, text);
    for (struct gscl_program *p = context->programs; p; p = p->next)
        if (p->kind == kind && strcmp(p->options, text) == 0) {
            *found = p;
            return GSCL_OK;
        }
    struct gscl_program *program = calloc(1, sizeof *program);
    if (!program)
        return gscl_fail_memory(context);
    program->kind = kind;
    memcpy(program->options, text, sizeof text);
    gscl_result result = program_build(context, program);
    if (result != GSCL_OK) {
        program_free(program);
        return result;
    }
    program->next = context->programs;
    context->programs = program;
    *found = program;
    return GSCL_OK;
}

gscl_result gscl_kernel(gscl_context *context, gscl_program_kind kind, const gscl_kernel_options *options,
                        const char *name, cl_kernel *kernel) {
    struct gscl_program *program;
    GSCL_TRY(program_get(context, kind, options, &program));
    for (size_t i = 0; i < program->kernel_count; i++)
        if (strcmp(program->kernels[i].name, name) == 0) {
            *kernel = program->kernels[i].kernel;
            return GSCL_OK;
        }
    if (program->kernel_count == MAX_KERNELS)
        return gscl_fail(context, GSCL_ERROR_KERNEL_BUILD, "too many kernels");
    cl_int error;
    *kernel = clCreateKernel(program->program, name, &error);
    if (error != CL_SUCCESS)
        return gscl_cl_fail(context, error, "clCreateKernel");
    program->kernels[program->kernel_count].name = name;
    program->kernels[program->kernel_count++].kernel = *kernel;
    return GSCL_OK;
}

void gscl_programs_free(gscl_context *context) {
    while (context->programs) {
        struct gscl_program *next = context->programs->next;
        program_free(context->programs);
        context->programs = next;
    }
}
