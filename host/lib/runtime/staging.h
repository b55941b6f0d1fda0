/* Copies from the host to the device without waiting, of data that may be released at once. */
#ifndef GSCL_LIB_STAGING_H
#define GSCL_LIB_STAGING_H

#include "runtime/buffer.h"

/* Memory of the host from which a buffer is written.  Zeroed: empty. */
typedef struct gscl_staging {
    void *memory;
    size_t size;    /* bytes */
    uint64_t waits; /* those of the context when it was last used: a later one has ended the copy */
} gscl_staging;

/* Copies the data to the memory, after waiting where the last copy from it may be going on, and from there to the buffer. */
gscl_result gscl_buffer_write_staged(gscl_context *context, gscl_staging *staging, const gscl_buffer *buffer,
                                     size_t offset, const void *data, size_t size);
/* Accepts an empty one; waits if a copy may still be going on. */
void gscl_staging_free(gscl_context *context, gscl_staging *staging);

#endif
