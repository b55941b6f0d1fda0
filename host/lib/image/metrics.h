/* Measures of the difference between two images. */
#ifndef GSCL_LIB_METRICS_H
#define GSCL_LIB_METRICS_H

#include <gscl/gscl.h>
#include <gscl/measure.h>

/* gscl_compare without the structural measures, which take most of its time: `mse`, `psnr` and `max_difference`;
 * the others are NaN. */
gscl_result gscl_compare_samples(const gscl_image *a, const gscl_image *b, gscl_comparison *comparison);
/* `ssimulacra2` of gscl_compare alone, with the same errors.  It takes 60 bytes of memory for each pixel, and 8 for each
 * sample. */
gscl_result gscl_compare_appearance(const gscl_image *a, const gscl_image *b, double *score);

#define GSCL_MS_SSIM_SCALES 5
/* The exponent of each scale of MS-SSIM, the finest first (Wang et al. 2003, "Multi-scale structural similarity"). */
extern const double gscl_ms_ssim_exponents[GSCL_MS_SSIM_SCALES];

#endif
