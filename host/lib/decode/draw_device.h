/* Drawing a file on an OpenCL device. */
#ifndef GSCL_LIB_DRAW_DEVICE_H
#define GSCL_LIB_DRAW_DEVICE_H

#include "decode/coded_image.h"
#include "decode/draw_progress.h"
#include "decode/output.h"

/* Draws into the image of the output, which has pixels. */
gscl_result gscl_draw_on_device(gscl_context *context, const gscl_coded_image *coded, const gscl_frame *f,
                                const gscl_output *o, const gscl_draw_progress *progress);

#endif
