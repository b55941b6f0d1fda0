#include "runtime/context.h"

#include <stdarg.h>
#include <stdio.h>

gscl_result gscl_fail(gscl_context *context, gscl_result result, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(context->message, sizeof context->message, format, arguments);
    va_end(arguments);
    return result;
}

gscl_result gscl_fail_memory(gscl_context *context) {
    return gscl_fail(context, GSCL_ERROR_OUT_OF_MEMORY, "out of memory");
}

void gscl_log(const gscl_context *context, gscl_log_level level, const char *format, ...) {
    if (!context->log)
        return;
    char text[4096];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    context->log(context->log_opaque, level, text);
}
