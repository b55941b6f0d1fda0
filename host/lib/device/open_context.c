/* Public functions that create, free and query a context. */
#include <stdlib.h>

#include "device/open_device.h"
#include "runtime/context.h"
#include "runtime/struct_size.h"

void gscl_context_settings_init(gscl_context_settings *settings, size_t struct_size) {
    const gscl_context_settings defaults = {0};
    gscl_struct_init(settings, struct_size, &defaults, sizeof defaults);
}

gscl_result gscl_context_create(gscl_context **context, const gscl_context_settings *settings) {
    if (!context)
        return GSCL_ERROR_INVALID_ARGUMENT;
    gscl_context *c = *context = calloc(1, sizeof *c);
    if (!c)
        return GSCL_ERROR_OUT_OF_MEMORY;
    gscl_context_settings s;
    gscl_context_settings_default(&s);
    GSCL_TRY(GSCL_STRUCT_READ(c, gscl_context_settings, log, settings, &s));
    c->log = s.log;
    c->log_opaque = s.log_opaque;
    c->build = s.build;
    c->build_opaque = s.build_opaque;
    if ((int)s.mapping < GSCL_MAPPING_AUTO || s.mapping > GSCL_MAPPING_GPU)
        return gscl_fail(c, GSCL_ERROR_INVALID_ARGUMENT, "mapping %d is none of auto, cpu and gpu", (int)s.mapping);
    if (s.threads < 0 || s.threads > GSCL_MAX_THREADS)
        return gscl_fail(c, GSCL_ERROR_INVALID_ARGUMENT, "%d threads: there may be 1 to %d, or 0 for all", s.threads,
                         GSCL_MAX_THREADS);
    GSCL_TRY(gscl_device_open(c, &s));
    c->is_open = true;
    gscl_log(c, GSCL_LOG_INFO, "device %s: %s%s", c->info.id, c->info.device_name,
             !c->backend      ? ""
             : c->gpu_mapping ? " (GPU mapping)"
                              : " (CPU mapping)");
    return GSCL_OK;
}

void gscl_context_free(gscl_context **context) {
    if (!context || !*context)
        return;
    gscl_context *c = *context;
    gscl_call_begin(c, "gscl_context_free");
    if (c->decoder)
        c->decoder_free(c->decoder);
    gscl_device_close(c);
    free(c);
    *context = NULL;
}

const char *gscl_context_message(const gscl_context *context) {
    return context ? context->message : "";
}

const gscl_device_info *gscl_context_device(const gscl_context *context) {
    return context ? &context->info : NULL;
}
