/* The size at which a decode draws the image, the rectangle that it returns, and the limits on both. */
#ifndef GSCL_LIB_FRAME_H
#define GSCL_LIB_FRAME_H

#include <gscl/gscl.h>

#include "decode/coded_image.h"
#include "runtime/real.h"

typedef struct gscl_frame {
    uint32_t full_width, full_height; /* of the whole drawn image, pixels */
    uint32_t x, y, width, height;     /* the rectangle that is returned */
    gscl_real scale_x, scale_y;       /* of the whole drawn image, relative to the encoded size */
} gscl_frame;

/* Computes the frame from the settings and checks it against max_pixels and, as far as the header allows, max_work.  It
 * allocates nothing. */
gscl_result gscl_frame_resolve(const gscl_decode_settings *s, const gsf_header *header, gscl_frame *f);

/* The options of what draws the frame: those of the file, but for splats that the frame's size turns. */
gscl_kernel_options gscl_frame_options(const gsf_header *header, const gscl_frame *f);

/* The number of pixels of the rectangle. */
uint64_t gscl_frame_pixels(const gscl_frame *f);

/* Dequantises splat `i` for the drawn image, into GSCL_PARAMS parameters. */
void gscl_frame_splat(const gsf_coded_image *coded, uint32_t i, const gscl_frame *f, float *params);

/* Evaluations of a splat at a pixel, as gscl_info.work defines them. */
uint64_t gscl_frame_work(const gsf_coded_image *coded, const gscl_frame *f);

/* The same where it is above max_work; else 0. */
uint64_t gscl_frame_excess_work(const gscl_decode_settings *s, const gsf_coded_image *coded, const gscl_frame *f);

#endif
