/* Structural similarity on the device (cl/ssim.cl): the loss (1 - w) L1 + w (1 - SSIM) / 2, and weights with which
 * squared error takes the place of MS-SSIM. */
#ifndef GSCL_LIB_SSIM_LOSS_H
#define GSCL_LIB_SSIM_LOSS_H

#include "runtime/buffer.h"
#include "runtime/launch.h"

/* Padded maps of all channels, kept between calls for images of the same size. */
typedef struct gscl_ssim {
    gscl_buffer moments; /* of windows: also their sums at pixels, once the moments are not needed */
    gscl_buffer maps;    /* derivatives, or weights, contrast gains and means of windows */
    int width, height, channels;
} gscl_ssim;

/* Writes dL/drendering times the number of samples into `derivative` (planes like `rendering`, which it makes).
 * `weight`: w.  Images smaller than a window have no SSIM term. */
gscl_result gscl_ssim_derivative(gscl_ssim *ssim, gscl_context *context, const gscl_kernel_options *options, int width,
                                 int height, const gscl_buffer *rendering, const gscl_buffer *target, float weight,
                                 gscl_buffer *derivative);
/* Writes the weight of each pixel's squared error for SSIM at this scale, 0..channels, into `weights` (a plane, which
 * it makes).  Weights are lower where the target and the rendering have high variance.  `rendering` may be NULL: there
 * is none yet. */
gscl_result gscl_ssim_weights(gscl_ssim *ssim, gscl_context *context, const gscl_kernel_options *options, int width,
                              int height, const gscl_buffer *rendering, const gscl_buffer *target,
                              gscl_buffer *weights);
/* After gscl_ssim_weights with a rendering: the factor, less 1, by which contrast around the local mean must be raised
 * so that the gradient of squared error approximates that of SSIM.  Writes a plane of factors for each channel, 0..0.5,
 * then a plane of means for each channel.  Images of at least 11x11 pixels. */
gscl_result gscl_ssim_contrast_gains(gscl_ssim *ssim, gscl_context *context, const gscl_kernel_options *options,
                                     int width, int height, gscl_buffer *gains);
/* Accepts a zeroed state. */
void gscl_ssim_free(gscl_ssim *ssim);

#endif
