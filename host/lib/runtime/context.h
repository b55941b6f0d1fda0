/* The library's context: a device, what is known of its work, and the text of the last error. */
#ifndef GSCL_LIB_CONTEXT_H
#define GSCL_LIB_CONTEXT_H

#include <gscl/gscl.h>

#include "runtime/stages.h"
#include "runtime/text.h"

#define GSCL_MESSAGE_SIZE 512

struct gscl_backend;     /* backend.h */
struct gscl_work_shapes; /* mapping.h */
struct gscl_timings;     /* timing.c */
struct gscl_parked;      /* queue.c */

/* Wall-clock time and number of runs of one stage. */
typedef struct gscl_stage_time_sum {
    uint64_t count;
    uint64_t waits; /* of the host for the device */
    double seconds, kernel_seconds;
} gscl_stage_time_sum;

/* The stage that is running, and the times of all stages so far (timing.h). */
typedef struct gscl_stage_clock {
    int users;   /* nothing is measured, and nothing waits for the device, while this is 0 */
    bool frozen; /* a change of stage is ignored */
    gscl_stage_id current;
    double start_s; /* when the current stage began, on the clock of gscl_now */
    gscl_stage_time_sum sums[GSCL_STAGE_COUNT];
} gscl_stage_clock;

struct gscl_context {
    const struct gscl_backend *backend; /* the implementation of the device; NULL where it only decodes */
    void *device;                       /* its state; NULL likewise */
    gscl_device_info info;
    bool is_open;                          /* gscl_context_create succeeded */
    bool is_host;                          /* the device "host": the processor itself */
    bool is_cpu;                           /* the device is a CPU */
    bool gpu_mapping;                      /* GSCL_MAPPING_GPU; else GSCL_MAPPING_CPU */
    const struct gscl_work_shapes *shapes; /* what the implementation changes of the mappings; NULL without one */
    size_t largest_group;                  /* work-items of a work-group of the device, at most; 0: no limit */
    size_t largest_rdo_group;              /* likewise of a kernel that visits splats (mapping.h) */
    gscl_build_callback build;             /* may be NULL */
    void *build_opaque;
    bool has_work;  /* the device was asked for something since the host last waited for it */
    uint64_t waits; /* of the host for the device: calls after which it had no work */
    gscl_stage_clock clock;
    struct gscl_timings *timings; /* NULL unless the caller asked for timings */
    struct gscl_parked *parked;   /* memory to release later (queue.h), or NULL */
    void *decoder;                /* state that is kept between decodes (decode/decode.c), or NULL */
    void (*decoder_free)(void *decoder);
    gscl_log_callback log;
    void *log_opaque;
    char message[GSCL_MESSAGE_SIZE];
    const char *call; /* the public function that uses the context now, or NULL; kept by debug builds */
};

/* Stores the message (printf-style) of an error and returns `result`, so that a function can end with
 * `return gscl_fail(context, GSCL_ERROR_..., "...")`.  A message beyond GSCL_MESSAGE_SIZE ends with "...". */
GSCL_PRINTF(3, 4)
gscl_result gscl_fail(gscl_context *context, gscl_result result, const char *format, ...);

/* Stores "out of memory" and returns GSCL_ERROR_OUT_OF_MEMORY: the host has no memory left. */
gscl_result gscl_fail_memory(gscl_context *context);

/* Fails with GSCL_ERROR_INVALID_ARGUMENT where gscl_context_create failed: such a context only has a message. */
gscl_result gscl_require_open(gscl_context *context);
/* Fails likewise, and with GSCL_ERROR_NO_ENCODER and a message that names the activity ("encoding") where the context's
 * device only decodes. */
gscl_result gscl_require_encoder(gscl_context *context, const char *activity);

/* Static analysers read one source file at a time; these macros state that a failure is never GSCL_OK. */
#ifdef __clang_analyzer__
#define gscl_fail(context, result, ...) ((void)gscl_fail(context, result, __VA_ARGS__), (result))
#define gscl_fail_memory(context) ((void)gscl_fail_memory(context), GSCL_ERROR_OUT_OF_MEMORY)
#endif

/* Public calls begin without a message, and end with one when they fail: errors of functions that have no context get
 * the text of their result.  `context` may be NULL. */
void gscl_forget_message(gscl_context *context);
gscl_result gscl_complete_message(gscl_context *context, gscl_result result);

/* Begins and ends a public call, likewise, that no other may meet in the same context.  A debug build (without NDEBUG)
 * names both on standard error and aborts when one does: what two threads do to a context is undefined. */
void gscl_call_begin(gscl_context *context, const char *function);
gscl_result gscl_call_end(gscl_context *context, gscl_result result);

GSCL_PRINTF(3, 4)
void gscl_log(const gscl_context *context, gscl_log_level level, const char *format, ...);

/* Calls the caller's `build`, if there is one. */
void gscl_report_build(const gscl_context *context, bool begins);

/* Returns from the function when the call fails. */
#define GSCL_TRY(call)                    \
    do {                                  \
        gscl_result try_result_ = (call); \
        if (try_result_ != GSCL_OK)       \
            return try_result_;           \
    } while (0)

#endif
