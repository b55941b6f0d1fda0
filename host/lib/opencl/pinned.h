/* Reading large results from a device with memory of its own.
 *
 * A driver copies into ordinary memory of the host through a small memory of its own, in which the device can write, and the
 * rows of a picture one by one.  Here the device fills the halves of a memory of this kind in turn, while the host copies
 * the other one to its place.  The memory is allocated and mapped at the first such read and kept with the device. */
#ifndef GSCL_LIB_PINNED_H
#define GSCL_LIB_PINNED_H

#include "opencl/opencl_device.h"

/* Bytes of a device that come to lie in rows of `row` bytes, `stride` bytes apart. */
typedef struct gscl_pinned_rows {
    size_t offset; /* of the first byte on the device */
    size_t row, rows, stride;
    void *data;
} gscl_pinned_rows;

/* Whether such a read is to go through pinned memory; makes it where it must.  Where it cannot be had, no read ever is. */
bool gscl_pinned_serves(gscl_context *context, const gscl_pinned_rows *rows);
/* Reads them and waits for the end. */
gscl_result gscl_pinned_read(gscl_context *context, cl_mem memory, const gscl_pinned_rows *rows);
/* Releases the memory before the queue is released; there may be none. */
void gscl_pinned_free(gscl_opencl_device *device);

#endif
