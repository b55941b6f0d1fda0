#include "runtime/context.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "runtime/text.h"

#define MAX_LOG_MESSAGE 4096 /* bytes, the NUL included */

gscl_result(gscl_fail)(gscl_context *context, gscl_result result, const char *format, ...) {
    char whole[2 * GSCL_MESSAGE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(whole, sizeof whole, format, arguments);
    va_end(arguments);
    gscl_text_shorten(context->message, sizeof context->message, whole);
    return result;
}

gscl_result(gscl_fail_memory)(gscl_context *context) {
    return gscl_fail(context, GSCL_ERROR_OUT_OF_MEMORY, "out of memory");
}

gscl_result gscl_require_open(gscl_context *context) {
    if (context->is_open)
        return GSCL_OK;
    return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT,
                     "the context has no device, because gscl_context_create failed");
}

gscl_result gscl_require_encoder(gscl_context *context, const char *activity) {
    GSCL_TRY(gscl_require_open(context));
    if (context->backend)
        return GSCL_OK;
    return gscl_fail(context, GSCL_ERROR_NO_ENCODER,
                     "%s needs kernels, and the device \"host\" of this library only decodes: it was built without "
                     "kernels for this processor; choose an OpenCL device",
                     activity);
}

void gscl_forget_message(gscl_context *context) {
    if (context)
        context->message[0] = 0;
}

gscl_result gscl_complete_message(gscl_context *context, gscl_result result) {
    if (context && result != GSCL_OK && !context->message[0])
        return gscl_fail(context, result, "%s", gscl_result_text(result));
    return result;
}

#if !defined(NDEBUG) && defined(__GNUC__)
/* Atomic, so that of two threads one sees the other. */
static const char *call_exchange(gscl_context *context, const char *function) {
    return __atomic_exchange_n(&context->call, function, __ATOMIC_ACQ_REL);
}
#else
static const char *call_exchange(gscl_context *context, const char *function) {
    (void)context, (void)function;
    return NULL;
}
#endif

void gscl_call_begin(gscl_context *context, const char *function) {
    const char *other = call_exchange(context, function);
    if (other) {
        fprintf(stderr,
                "gscl: %s is called with a context that %s is using in another thread, or in its callback; give each "
                "thread a context of its own\n",
                function, other);
        abort();
    }
    gscl_forget_message(context);
}

gscl_result gscl_call_end(gscl_context *context, gscl_result result) {
    const gscl_result completed = gscl_complete_message(context, result);
    call_exchange(context, NULL);
    return completed;
}

void gscl_report_build(const gscl_context *context, bool begins) {
    if (context->build)
        context->build(context->build_opaque, begins);
}

void gscl_log(const gscl_context *context, gscl_log_level level, const char *format, ...) {
    if (!context->log)
        return;
    char text[MAX_LOG_MESSAGE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    context->log(context->log_opaque, level, text);
}
