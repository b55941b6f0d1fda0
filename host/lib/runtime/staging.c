#include "runtime/staging.h"

#include <stdlib.h>
#include <string.h>

#include "runtime/queue.h"

gscl_result gscl_buffer_write_staged(gscl_context *context, gscl_staging *staging, const gscl_buffer *buffer,
                                     size_t offset, const void *data, size_t size) {
    if (size == 0)
        return GSCL_OK;
    if (staging->memory && staging->waits == context->waits)
        GSCL_TRY(gscl_finish(context)); /* the last copy may be going on */
    if (!staging->memory || size > staging->size) {
        free(staging->memory);
        staging->memory = malloc(size);
        staging->size = staging->memory ? size : 0;
        if (!staging->memory)
            return gscl_fail_memory(context);
    }
    memcpy(staging->memory, data, size);
    staging->waits = context->waits;
    return gscl_buffer_write_async(context, buffer, offset, staging->memory, size);
}

void gscl_staging_free(gscl_context *context, gscl_staging *staging) {
    if (staging->memory && staging->waits == context->waits)
        gscl_release_after_copies(context, staging->memory);
    else
        free(staging->memory);
    *staging = (gscl_staging){0};
}
