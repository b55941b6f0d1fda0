/* The library's context: an OpenCL device, its queue, its kernels, and the text of the last error. */
#ifndef GSCL_LIB_CONTEXT_H
#define GSCL_LIB_CONTEXT_H

#include <CL/cl.h>
#include <gscl/gscl.h>

#define GSCL_MESSAGE_SIZE 512

struct gscl_program;  /* kernels.h */
struct gscl_timings;  /* timing.h */
struct gscl_renderer; /* render.h */
struct gscl_recorder; /* report.h */

struct gscl_context {
    cl_platform_id platform;
    cl_device_id device;
    cl_context cl;
    cl_command_queue queue;
    gscl_device_info info;
    bool gpu_mapping;
    struct gscl_program *programs;  /* built so far, a list */
    bool needs_header;              /* cl/builtins.h was not enough for one of them */
    struct gscl_timings *timings;   /* NULL when nothing is measured */
    bool stages_frozen;             /* what runs is a part of the stage under way (timing.h) */
    struct gscl_renderer *renderer; /* of the last decode, or NULL */
    struct gscl_recorder *recorder; /* of the encode under way, or NULL */
    gscl_log_callback log;
    void *log_opaque;
    char message[GSCL_MESSAGE_SIZE];
};

/* Keeps the message (printf-style) of an error and returns `result`, so that a function can end with
 * `return gscl_fail(context, GSCL_ERROR_..., "...")`. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
gscl_result
gscl_fail(gscl_context *context, gscl_result result, const char *format, ...);

#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
void gscl_log(const gscl_context *context, gscl_log_level level, const char *format, ...);

/* Releases what decodes have left in the context (decode.c). */
void gscl_decoder_free(gscl_context *context);

/* Forwards an error. */
#define GSCL_TRY(call)                    \
    do {                                  \
        gscl_result try_result_ = (call); \
        if (try_result_ != GSCL_OK)       \
            return try_result_;           \
    } while (0)

/* Forwards an error to the label `fail`, where `result` is returned after releasing. */
#define GSCL_TRY_OR_FAIL(call) \
    do {                       \
        result = (call);       \
        if (result != GSCL_OK) \
            goto fail;         \
    } while (0)

#endif
