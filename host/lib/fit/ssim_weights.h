/* Squared errors in place of MS-SSIM: a weight for each pixel, and a target with more contrast (cl/ssim.cl). */
#ifndef GSCL_LIB_FIT_SSIM_WEIGHTS_H
#define GSCL_LIB_FIT_SSIM_WEIGHTS_H

#include "fit/pyramid.h"
#include "fit/ssim_loss.h"

/* Fills the plane of weights of each level of a pyramid that was created for them, from the source alone. */
gscl_result gscl_weights_build(const gscl_pyramid *pyramid, gscl_ssim *ssim, const gscl_kernel_options *options);
/* Writes the first level's planes into `adapted`, which it makes, such that the gradient of squared error against them
 * approximates that of MS-SSIM at `rendering` (planes of the first level's size): more contrast, and weights.  There
 * must be a second level. */
gscl_result gscl_weights_adapt(const gscl_pyramid *pyramid, gscl_ssim *ssim, const gscl_kernel_options *options,
                               const gscl_buffer *rendering, gscl_buffer *adapted);

#endif
