/* Structural similarity on the device (cl/ssim.cl): the loss (1 - w) L1 + w (1 - SSIM) / 2, and weights that make
 * squared error stand for MS-SSIM. */
#ifndef GSCL_LIB_SSIM_H
#define GSCL_LIB_SSIM_H

#include "runtime/programs.h"
#include "runtime/opencl.h"

typedef struct gscl_ssim {
    gscl_buffer moments, slopes;
    int width, height, channels; /* that the buffers' margins were zeroed for */
} gscl_ssim;

/* Writes dL/dpicture times the number of samples into `derivative` (planes like `picture`, which it makes).
 * `weight`: w.  Images smaller than a window have no SSIM term. */
gscl_result gscl_ssim_derivative(gscl_ssim *ssim, gscl_context *context, const gscl_kernel_options *options, int width,
                                 int height, const gscl_buffer *picture, const gscl_buffer *target, float weight,
                                 gscl_buffer *derivative);
/* Writes what each pixel's squared error counts towards SSIM at this scale, 0..channels, into `weights` (a plane, which
 * it makes): less where `target` is busy, and where the picture is busy.  `picture` may be NULL: not yet known. */
gscl_result gscl_ssim_weights(gscl_ssim *ssim, gscl_context *context, const gscl_kernel_options *options, int width,
                              int height, const gscl_buffer *picture, const gscl_buffer *target, gscl_buffer *weights);
/* After gscl_ssim_weights with a picture: by how much contrast around the local mean is to be raised so that squared
 * error leads where SSIM does; for each channel a plane of gains, 0..0.5, then for each one of means.  Images of at
 * least 11x11 pixels. */
gscl_result gscl_ssim_contrast_gains(gscl_ssim *ssim, gscl_context *context, const gscl_kernel_options *options,
                                     int width, int height, gscl_buffer *gains);
/* Accepts a zeroed state. */
void gscl_ssim_free(gscl_ssim *ssim);

#endif
