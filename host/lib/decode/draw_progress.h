/* The progress of a drawing: calls the caller's callback, which may cancel the decode. */
#ifndef GSCL_LIB_DRAW_PROGRESS_H
#define GSCL_LIB_DRAW_PROGRESS_H

#include <gscl/gscl.h>

#include "decode/frame.h"

typedef struct gscl_draw_progress {
    gscl_progress_callback callback; /* NULL: none, and nothing else is set */
    void *opaque;
    double start_s; /* of the decode, on the clock of gscl_now */
    uint32_t splats;
} gscl_draw_progress;

gscl_draw_progress gscl_draw_progress_begin(const gscl_decode_settings *s, const gscl_coded_image *coded,
                                            double start_s);
/* Reports that `rows` rows of the frame are drawn.  GSCL_ERROR_CANCELLED when the callback returns false. */
gscl_result gscl_draw_progress_report(gscl_context *context, const gscl_draw_progress *progress, const gscl_frame *f,
                                      uint32_t rows);

#endif
