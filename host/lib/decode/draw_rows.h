/* Draws a coded image by rows, in memory of the caller: what gscl_decode_rows does once it has read the file.  Any reader of a
 * coded image whose splats are in the stored order can use it. */
#ifndef GSCL_LIB_DRAW_ROWS_H
#define GSCL_LIB_DRAW_ROWS_H

#include <gscl/gscl.h>

#include "decode/output.h"

typedef struct gscl_rows {
    gscl_frame frame;
    gscl_output output;  /* of a whole decode, without pixels */
    uint32_t strip_rows; /* as in gscl_decode_rows */
    gscl_rows_callback callback;
    void *opaque; /* first argument of the callback */
} gscl_rows;

/* The least memory, in bytes, to draw a file with this header. */
uint64_t gscl_draw_rows_memory(const gsf_header *header, const gscl_rows *rows);

/* Draws all rows of the frame.  `memory` is aligned as for uint32_t.  The coded image is only read.  Results: GSCL_OK,
 * GSCL_ERROR_OUT_OF_MEMORY before the first call of the callback, GSCL_ERROR_CANCELLED. */
gscl_result gscl_draw_rows(const gsf_coded_image *coded, const gscl_rows *rows, void *memory, size_t memory_size);

#endif
