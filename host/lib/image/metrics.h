/* Measures of the difference between two images. */
#ifndef GSCL_LIB_METRICS_H
#define GSCL_LIB_METRICS_H

#include <gscl/gscl.h>
#include <gscl/measure.h>

/* gscl_compare without the structural measures, which take most of its time: `mse`, `psnr` and `max_difference`;
 * the others are NaN. */
gscl_result gscl_compare_samples(const gscl_image *a, const gscl_image *b, gscl_comparison *comparison);

#endif
